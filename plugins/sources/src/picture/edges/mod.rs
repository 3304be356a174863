//! Edges of a rendered picture with depth, taken apart into what is in front and what is behind.
//!
//! A renderer averages color over a pixel, so at the edge of a thing a pixel holds a mixture, `C = a N + (1 - a) F`, of the near
//! color `N` and the far color `F`. Depth cannot be averaged: it is that of one sample, and the mixture would lie as a whole at one
//! distance: a bright rim in the blur behind, or a sharp hair before a blurred wall. So the share `a` is taken for what it is, the
//! part of the pixel that the near thing covers.
//!
//! The data flow, each step a file:
//! 1. [`steps`]: which depths belong together, and which neighbors are apart.
//! 2. [`snap`]: depths that the renderer did average come to lie on one of the two sides.
//! 3. [`sides`]: of each pixel beside a step the pure near and far color, from clean pixels farther in; of what is too thin to have
//!    any, from the pixel that is most unlike the other side.
//! 4. [`share`]: the share by least squares in linear light, and the colors in front and behind that make up the pixel exactly.
//! 5. [`threads`]: a thread goes on where samples of depth fell beside it.
//! 6. Here: whether the picture has such pixels at all, and [`Mixed`], what lies behind them. In front of it each of them is a pixel of the
//!    near thing as any other, at its depth and in its color, through which a part of the light from behind comes.

mod parted;
mod share;
mod sides;
mod snap;
mod sparse;
mod steps;
mod threads;

use parted::Parted;
pub(super) use sparse::Sparse;
use steps::Steps;

/// What lies behind pixels that are covered in part.
pub(super) struct Mixed {
    /// Which pixels these are; the rest is in their order.
    pub cells: Sparse,
    pub behind: Vec<Behind>,
    /// How many of them hold a mixture; the others touch one, so that cover is smooth between them.
    pub parted: usize,
}

/// What lies behind one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Behind {
    /// The part of the pixel that what is in front covers.
    pub opacity: f32,
    /// The color of what is behind, linear light.
    pub rgb: [f32; 3],
    /// Its depth, mm.
    pub depth_mm: f32,
}

/// A picture is taken to hold mixtures where at least this part of the pixels beside steps, of those that can tell, is one.
const IS_MIXED: f64 = 0.05;

/// Takes the mixed pixels of a picture apart: what is in front stays in `rgb` and `depth_mm`, what is behind is returned. Neighbors whose
/// depths differ by more than the part `edge` belong to different things. A picture without mixed pixels stays as it is.
pub(super) fn part(rgb: &mut [[f32; 3]], depth_mm: &mut [f32], width: usize, edge: f64) -> Option<Mixed> {
    let mut steps = Steps::new(depth_mm, width, edge);
    if !steps.any() {
        return None;
    }
    let snapped = snap::averaged(&steps, depth_mm);
    if let Some(depth_mm) = &snapped {
        steps = Steps::new(depth_mm, width, edge);
    }
    let depths = snapped.as_deref().unwrap_or(depth_mm);
    let mut all: Vec<(u32, Parted)> = Vec::new();
    let mut is_thread = Vec::new();
    let (mut tell, mut mixed) = (0_usize, 0_usize);
    for cell in (0..rgb.len()).filter(|cell| steps.is_beside(*cell)) {
        let Some(sides) = sides::of(&steps, rgb, depths, cell) else { continue };
        if let Some(is_mixed) = sides.tells(&rgb[cell]) {
            tell += 1;
            mixed += usize::from(is_mixed);
        }
        if let Some(parted) = share::part(&sides, rgb[cell]) {
            all.push((cell as u32, parted));
            is_thread.push(sides.near.spread.is_none());
        }
    }
    // Where depth was averaged, color was.
    let is_mixed = snapped.is_some() || mixed > 0 && mixed as f64 >= IS_MIXED * tell as f64;
    if all.is_empty() || !is_mixed {
        return None;
    }
    threads::follow(&steps, rgb, &mut all, &is_thread);
    let parted = all.len();
    let found = around(&steps, rgb, depths, all);
    let cells = Sparse::new(rgb.len(), found.iter().map(|(cell, _)| *cell as usize));
    if let Some(snapped) = snapped {
        depth_mm.copy_from_slice(&snapped);
    }
    let behind = found.iter().map(|(cell, parted)| {
        let cell = *cell as usize;
        (rgb[cell], depth_mm[cell]) = (parted.near, parted.near_mm);
        Behind { opacity: parted.opacity, rgb: parted.far, depth_mm: parted.far_mm }
    });
    let behind = behind.collect();
    Some(Mixed { cells, behind, parted })
}

/// The mixed pixels and all that touch them, so that cover can be linear between their centers: on the near side whole, with the far
/// thing behind, on the far side nothing, with the near thing in front.
fn around(steps: &Steps, rgb: &[[f32; 3]], depth_mm: &[f32], mut all: Vec<(u32, Parted)>) -> Vec<(u32, Parted)> {
    const NONE: u32 = u32::MAX;
    let mut places = vec![NONE; rgb.len()];
    for (place, (cell, _)) in all.iter().enumerate() {
        places[*cell as usize] = place as u32;
    }
    let mixed = all.len();
    for k in 0..mixed {
        let (cell, parted) = all[k];
        for beside in steps.window(cell as usize, 1) {
            let (own, own_mm) = (rgb[beside], depth_mm[beside]);
            let whole = if steps.are_together(own_mm, parted.near_mm) {
                Parted { opacity: 1.0, near: own, near_mm: own_mm, ..parted }
            } else if steps.are_together(own_mm, parted.far_mm) {
                Parted { opacity: 0.0, far: own, far_mm: own_mm, ..parted }
            } else {
                continue;
            };
            let place = places[beside];
            if place == NONE {
                places[beside] = all.len() as u32;
                all.push((beside as u32, whole));
            }
        }
    }
    all.sort_unstable_by_key(|(cell, _)| *cell);
    all
}

#[cfg(test)]
mod tests;
