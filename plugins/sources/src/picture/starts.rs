//! The surfaces on which the rays start that a picture with depth emits: the planes of pixels, the steps between them, and the
//! background of mixed pixels.

use super::backdrop::Backdrop;
use super::height_field::{HeightField, Hit, Wall};
use super::picture_texture::PictureTexture;

/// Largest number of pixels that a tag can hold besides side and kind.
pub(super) const MOST_CELLS: usize = 1 << 28;
/// Bit of a tag: the ray starts on a step, on the side of the pixel given by [`SIDE_BITS`].
const IS_WALL: u32 = 1 << 31;
/// Bit of a tag: the ray starts on the background of mixed pixels.
const IS_BEHIND: u32 = 1 << 30;
/// Position of the two bits of a tag that hold the side of the step.
const SIDE_BITS: u32 = 28;
/// Estimated distance from the axis at which light enters a lens, mm. It sets how many rays start on steps, not how much light they
/// carry.
const OFF_AXIS_MM: f64 = 6.0;
/// Largest fraction of the rays that start on steps and backgrounds if planes in front emit light, too.
const MOST: f64 = 0.5;

/// The steps of a picture, and the planes and steps behind its mixed pixels. Each is drawn in proportion to the light expected from it.
pub(super) struct Starts {
    /// Tag of the rays that start on each surface.
    all: Vec<u32>,
    /// Cumulative probabilities up to and including each surface; the last is 1.
    sums: Vec<f64>,
    /// Guide table: [0, 1) is divided into as many equal parts as there are surfaces. Each entry is the surface at the lower end of its
    /// part.
    guide: Vec<u32>,
    /// Fraction of the rays that start on these surfaces.
    pub share: f64,
}

impl Starts {
    /// Finds the surfaces in a picture and in the background of its mixed pixels. A direction of slope 1 is `px_per_slope` pixels from the
    /// axis. `level` returns the brightness of a pixel, 0 if the pixel does not belong to this part of the picture.
    pub(super) fn of(
        map: &PictureTexture,
        front: &HeightField,
        behind: Option<&Backdrop>,
        px_per_slope: f64,
        level: impl Fn(usize) -> f32,
    ) -> Self {
        // Width of the background that a step hides, pixels per unit of 1/depth across the step.
        let hidden = px_per_slope * OFF_AXIS_MM;
        let around = |cell: usize| {
            let (column, row) = (cell % map.width_px, cell / map.width_px);
            let rows = row.saturating_sub(1)..=(row + 1).min(map.height_px - 1);
            let columns = column.saturating_sub(1)..=(column + 1).min(map.width_px - 1);
            rows.flat_map(|r| columns.clone().map(move |c| r * map.width_px + c)).map(&level).fold(0.0_f32, f32::max)
        };
        let (mut all, mut sums, mut sum) = (Vec::new(), Vec::new(), 0.0);
        let mut take = |tag: u32, part: f64| {
            if part > 0.0 {
                sum += part;
                all.push(tag);
                sums.push(sum);
            }
        };
        let mut walls = |field: &HeightField, cell: usize, kind: u32, wanted: &dyn Fn(usize) -> bool| {
            for side in 0..4 {
                let Some(nearer) = field.beside(cell, side).filter(|beside| field.w(*beside) > field.w(cell)) else {
                    continue;
                };
                // A step within one object has the light of its nearer pixel. Behind another object the background continues.
                let level = match field.together(cell, nearer) {
                    true => around(nearer),
                    false if map.is_light(cell) => 0.0,
                    false => level(cell),
                };
                if wanted(nearer) {
                    let range = field.w(nearer) - field.w(cell);
                    take(
                        kind | IS_WALL | u32::from(side) << SIDE_BITS | cell as u32,
                        f64::from(level) * hidden * range,
                    );
                }
            }
        };
        let mut planes = 0.0;
        for cell in 0..front.cells() {
            planes += f64::from(level(cell));
            walls(front, cell, 0, &|_| true);
        }
        if let Some(behind) = behind {
            for cell in 0..front.cells() {
                walls(&behind.field, cell, IS_BEHIND, &|nearer| behind.has(cell) || behind.has(nearer));
            }
            behind.cells().for_each(|cell| take(IS_BEHIND | cell as u32, f64::from(around(cell))));
        }
        let share = if sum > 0.0 { (sum / (sum + planes)).min(MOST) } else { 0.0 };
        sums.iter_mut().for_each(|s| *s /= sum);
        if let Some(last) = sums.last_mut() {
            *last = 1.0;
        }
        let mut at = 0;
        let guide = (0..sums.len()).map(|part| {
            let from = part as f64 / sums.len() as f64;
            while at + 1 < sums.len() && sums[at] <= from {
                at += 1;
            }
            at as u32 // there are at most nine per pixel
        });
        let guide = guide.collect();
        Self { all, sums, guide, share }
    }

    /// Draws a surface with a number from 0 to 1. Returns its tag, the number rescaled within its interval, and the inverse of its
    /// probability.
    pub(super) fn draw(&self, u: f64) -> (u32, f64, f64) {
        let many = self.sums.len();
        let mut at = self.guide[((u * many as f64) as usize).min(many - 1)] as usize;
        while at + 1 < many && self.sums[at] <= u {
            at += 1;
        }
        let from = if at > 0 { self.sums[at - 1] } else { 0.0 };
        let part = self.sums[at] - from;
        (self.all[at], ((u - from) / part).clamp(0.0, 1.0), 1.0 / part)
    }
}

/// The surface on which a ray starts.
pub(super) struct Start {
    pub cell: usize,
    /// The step, or `None` if the surface is the plane of a pixel.
    pub wall: Option<Wall>,
    /// Whether the surface lies behind mixed pixels.
    pub is_behind: bool,
}

impl Start {
    /// Reads the tag of a ray.
    pub(super) fn of(tag: u32) -> Self {
        let cell = tag & (MOST_CELLS as u32 - 1);
        let wall = (tag & IS_WALL != 0).then_some(Wall { cell, side: (tag >> SIDE_BITS & 3) as u8 });
        Self { cell: cell as usize, wall, is_behind: tag & IS_BEHIND != 0 }
    }

    /// Returns whether this is the surface that a ray meets.
    #[inline(always)]
    pub(super) fn is(&self, hit: &Hit) -> bool {
        match self.wall {
            Some(_) => hit.wall == self.wall,
            None => hit.wall.is_none() && hit.cell == self.cell,
        }
    }
}
