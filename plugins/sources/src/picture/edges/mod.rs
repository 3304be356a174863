//! Separates the edges of a rendered picture with depth into foreground and background.
//!
//! A renderer averages color over a pixel. A pixel at the edge of an object therefore contains a mixture of the near color `N`
//! and the far color `F`: `C = a N + (1 - a) F`. Depth cannot be averaged: it is the depth of one sample. The whole mixture would
//! therefore lie at one distance, as a bright rim in the blur behind, or as a sharp hair in front of a blurred wall. To avoid
//! this, the share `a` is used as the fraction of the pixel that the near object covers.
//!
//! The data flow, with one file per step:
//! 1. [`steps`]: finds which depths belong together, and where neighbors do not.
//! 2. [`snap`]: assigns depths that the renderer did average to one of the two sides.
//! 3. [`sides`]: finds the pure near and far color for each pixel beside a step, from clean pixels farther away. If an object is too thin
//!    to have any, it uses the pixel that differs most from the other side.
//! 4. [`share`]: computes the share by least squares in linear light, and the front and back colors that make up the pixel exactly.
//! 5. [`threads`]: follows a thread where the depth samples missed it.
//! 6. This file: decides whether the picture has such pixels at all, and makes [`Mixed`], their background. In front, each of them is an
//!    ordinary pixel of the near object, at its depth and in its color, through which a part of the light from behind passes.
//!
//! Whether a picture has mixtures is decided for all of it. If it has none, there is no second height field ([`super::backdrop`]), and
//! the bits are those of `edges: as-is`.

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

/// The background of pixels that are covered only in part.
pub(super) struct Mixed {
    /// Set of these pixels; `behind` is in the same order.
    pub cells: Sparse,
    pub behind: Vec<Behind>,
    /// Number of pixels that hold a mixture. The others touch one, so that coverage is smooth between them.
    pub parted: usize,
}

/// The background of one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Behind {
    /// Fraction of the pixel that the foreground covers, 0 to 1.
    pub opacity: f32,
    /// Color of the background, linear light.
    pub rgb: [f32; 3],
    /// Depth of the background, mm.
    pub depth_mm: f32,
}

/// Smallest fraction of mixtures, among the pixels beside steps that can be judged, from which a picture counts as having mixed
/// pixels.
const IS_MIXED: f64 = 0.05;

/// Separates the mixed pixels of a picture: the foreground stays in `rgb` and `depth_mm`, and the background is returned. Neighbors whose
/// depths differ by more than the fraction `edge` belong to different objects. A picture without mixed pixels does not change; returns
/// `None`.
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
    // If depth was averaged, color was averaged, too.
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

/// Adds all pixels that touch mixed ones, so that coverage can be linear between their centers. On the near side they are fully covered,
/// with the far object behind; on the far side they are not covered, with the near object in front.
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
