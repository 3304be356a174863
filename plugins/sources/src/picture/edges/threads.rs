//! Follows threads where the depth samples missed them. Such pixels have the depth of the wall.

use super::parted::Parted;
use super::share;
use super::sides::{self, length, minus};
use super::steps::{Steps, WAYS};

/// Number of pixels for which a thread is followed beyond the last one with its own depth.
const FOLLOWED: usize = 24;
/// Number of pixels for which a thread is followed even among other threads. Beyond them it must be thin.
const AMONG_OTHERS: usize = 4;
/// Distance from a thread, in pixels, at which the pixels on both sides must contain less than half as much of the thread.
const BESIDE: isize = 3;
/// Smallest coverage of a pixel with which a thread continues.
const LEAST: f32 = 0.05;

/// Continues from mixed pixels of threads, which have no clean near side, to pixels that touch them and do not lie beside a step. Appends
/// the pixels found to `all`. `is_thread` says which of `all` belong to a thread.
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

/// Returns whether a pixel differs from the background more than twice as much as pixels on both sides of it.
fn is_thin(steps: &Steps, rgb: &[[f32; 3]], cell: usize, behind: [f32; 3]) -> bool {
    let off = |cell: usize| length(minus(rgb[cell].map(f64::from), behind.map(f64::from)));
    let own = off(cell);
    WAYS.iter().any(|way| {
        let is_less = |k: isize| steps.along(cell, *way, k).is_some_and(|beside| off(beside) < 0.5 * own);
        is_less(-BESIDE) && is_less(BESIDE)
    })
}
