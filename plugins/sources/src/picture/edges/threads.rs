//! What of a thread has no depth: samples that fell beside it have that of the wall.

use super::parted::Parted;
use super::share;
use super::sides::{self, length, minus};
use super::steps::{Steps, WAYS};

/// So many pixels on from the last one that a sample fell on, a thread is followed.
const FOLLOWED: usize = 24;
/// So many of them also among others; farther on it must be thin by itself.
const AMONG_OTHERS: usize = 4;
/// What is so many pixels beside a thread has less than half of it.
const BESIDE: isize = 3;
/// A thread goes on where it covers more than this part of a pixel.
const LEAST: f32 = 0.05;

/// Goes on from mixed pixels of threads, which have no clean near side, to those that touch them and are no more beside a step.
/// `is_thread` says of each of `all` whether it is one of a thread.
pub(super) fn follow(steps: &Steps, rgb: &[[f32; 3]], all: &mut Vec<(u32, Parted)>, is_thread: &[bool]) {
    let mut known = vec![false; rgb.len()];
    all.iter().for_each(|(cell, _)| known[*cell as usize] = true);
    let threads = all.iter().zip(is_thread).filter(|(_, is_thread)| **is_thread);
    let mut front: Vec<(u32, Parted)> = threads.map(|(from, _)| *from).collect();
    for step in 0..FOLLOWED {
        let mut next = Vec::new();
        for (cell, from) in front {
            for beside in steps.window(cell as usize, 1) {
                if known[beside] || steps.is_beside(beside) {
                    continue;
                }
                known[beside] = true;
                let Some(sides) = sides::behind(steps, rgb, beside, &from) else { continue };
                let parted = share::part(&sides, rgb[beside]).filter(|parted| {
                    let is_on = step < AMONG_OTHERS || is_thin(steps, rgb, beside, parted.far);
                    is_on && parted.opacity > LEAST
                });
                next.extend(parted.map(|parted| (beside as u32, parted)));
            }
        }
        all.extend(&next);
        front = next;
    }
}

/// Whether a pixel differs from what is behind more than twice as much as pixels on both hands of it.
fn is_thin(steps: &Steps, rgb: &[[f32; 3]], cell: usize, behind: [f32; 3]) -> bool {
    let off = |cell: usize| length(minus(rgb[cell].map(f64::from), behind.map(f64::from)));
    let own = off(cell);
    WAYS.iter().any(|way| {
        let is_less = |k: isize| steps.along(cell, *way, k).is_some_and(|beside| off(beside) < 0.5 * own);
        is_less(-BESIDE) && is_less(BESIDE)
    })
}
