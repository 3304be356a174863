//! Corrects depths that the renderer averaged over a pixel: there is no surface at such a depth.
//!
//! Across an edge such a depth lies between a near and a far side, each of which has the same depth for two pixels. A slope, such as a
//! floor toward its horizon, has no such sides. A thread thinner than a pixel has no near side: the far side lies on both sides of it, and
//! its own depth is the nearest one found along it. A single strip between two objects proves nothing, so the picture is judged as a
//! whole: if a renderer averages edges, most of them are averaged.

use super::steps::{Steps, WAYS};

/// Number of pixels over which an edge may be smeared on one side of a pixel within it.
const REACH: isize = 2;
/// Smallest fraction of averaged edges from which the depths of a picture count as averaged.
const IS_AVERAGED: f64 = 0.25;
/// Distance along a thread, in pixels, within which its depth is searched for.
const ALONG: usize = 6;

/// Returns the depths (mm), with each averaged one replaced by that of the side to which it is closer. `None` if the picture's
/// depths are not averaged.
pub(super) fn averaged(steps: &Steps, depth_mm: &[f32]) -> Option<Vec<f32>> {
    let (mut sharp, mut smeared) = (0_usize, 0_usize);
    let mut moved: Vec<(usize, f32)> = Vec::new();
    let (mut threads, mut is_thread_cell) = (Vec::new(), vec![false; depth_mm.len()]);
    for cell in (0..depth_mm.len()).filter(|cell| steps.is_beside(*cell)) {
        sharp += usize::from(WAYS[..2].iter().any(|way| is_sharp(steps, cell, *way)));
        if WAYS.iter().any(|way| is_thread(steps, cell, *way)) {
            threads.push(cell);
            is_thread_cell[cell] = true;
        } else if let Some([near, far]) = WAYS.iter().find_map(|way| smeared_along(steps, cell, *way)) {
            smeared += 1;
            let [own, near_mm, far_mm] = [cell, near, far].map(|cell| depth_mm[cell]);
            moved.push((cell, if far_mm - own >= own - near_mm { near_mm } else { far_mm }));
        }
    }
    for cell in threads {
        let beside = steps.window(cell, ALONG).filter(|beside| is_thread_cell[*beside]);
        let nearest = beside.fold(cell, |a, b| if steps.w(b) > steps.w(a) { b } else { a });
        if steps.together(cell, nearest) {
            sharp += 1;
        } else {
            smeared += 1;
            moved.push((cell, depth_mm[nearest]));
        }
    }
    if smeared == 0 || (smeared as f64) < IS_AVERAGED * (smeared + sharp) as f64 {
        return None;
    }
    let mut all = depth_mm.to_vec();
    moved.into_iter().for_each(|(cell, mm)| all[cell] = mm);
    Some(all)
}

/// Returns whether a sharp edge runs between a pixel and the next one along `way`.
fn is_sharp(steps: &Steps, cell: usize, way: [isize; 2]) -> bool {
    let at = |k| steps.along(cell, way, k);
    let (Some(before), Some(next), Some(beyond)) = (at(-1), at(1), at(2)) else { return false };
    steps.together(before, cell) && !steps.together(cell, next) && steps.together(next, beyond)
}

/// Returns pixels of the near and of the far side of a smeared edge that contains a pixel; `None` if there is no such edge along `way`.
fn smeared_along(steps: &Steps, cell: usize, way: [isize; 2]) -> Option<[usize; 2]> {
    let side = |sign: isize| {
        let level = (1..=REACH).find_map(|k| {
            let [at, beyond] = [k, k + 1].map(|k| steps.along(cell, way, sign * k));
            let (at, beyond) = (at?, beyond?);
            (!steps.together(cell, at) && steps.together(at, beyond)).then_some(at)
        });
        level.filter(|at| !steps.together(cell, *at))
    };
    let (a, b) = (side(-1)?, side(1)?);
    let own = steps.w(cell);
    let (near, far) = if steps.w(a) > steps.w(b) { (a, b) } else { (b, a) };
    (steps.w(near) > own && own > steps.w(far)).then_some([near, far])
}

/// Returns whether the same farther object lies on both sides of a pixel along `way`.
fn is_thread(steps: &Steps, cell: usize, way: [isize; 2]) -> bool {
    let side = |sign: isize| {
        let all = (1..=REACH + 1).filter_map(|k| steps.along(cell, way, sign * k));
        let farthest = all.reduce(|a, b| if steps.w(b) < steps.w(a) { b } else { a });
        farthest.filter(|at| steps.w(*at) < steps.w(cell) && !steps.together(cell, *at))
    };
    matches!((side(-1), side(1)), (Some(a), Some(b)) if steps.together(a, b))
}
