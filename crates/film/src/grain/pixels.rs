//! What the density of a pixel becomes, over that density and its normal number, sampled for pixels of one size.

use super::count::{Counts, FINENESS, LIMIT, NODES};
use rayon::prelude::*;

/// Samples a unit of the root of the density, and how many: up to a density of 4.
const STEPS: usize = 512;
const ROWS: usize = 1024;

/// Samples over the normal number are those of [`Counts`], in a row that a shift finds.
const ROW: usize = 512;
const ALL: usize = ROWS * ROW;

/// Densities, row by row.
pub(super) struct Pixels {
    values: Box<[f32; ALL]>,
}

impl Pixels {
    /// Those of pixels in which a grain's density is `one(density)`, none where that is 0; `alone` as [`Counts::evened`] has it.
    pub(super) fn new(counts: &Counts, alone: f32, one: impl Fn(f32) -> f32 + Sync) -> Self {
        let mut values = vec![0.0_f32; ALL];
        values.par_chunks_mut(ROW).enumerate().for_each(|(k, row)| {
            let root = k as f32 / STEPS as f32;
            let (density, place) = (root * root, |i: usize| i as f32 / FINENESS as f32 - LIMIT as f32);
            let one = one(density);
            let mean = if one > 0.0 { counts.evened(density / one, alone) } else { 0.0 };
            for (i, value) in row[..NODES].iter_mut().enumerate() {
                *value = if mean > 0.0 { density * counts.quantile(mean, place(i)) / mean } else { density };
            }
        });
        let values = values.into_boxed_slice().try_into().unwrap_or_else(|_| unreachable!("it was made of that size"));
        Self { values }
    }

    /// The density that `density` becomes by the number `z`; no number where it is not above 0, or beyond the last row.
    ///
    /// Between two rows linear in the density, so that the mean over z stays.
    #[inline(always)]
    pub(super) fn at(&self, density: f32, z: f32) -> f32 {
        let root = density.sqrt() * STEPS as f32;
        let is_here = root > 0.0 && root < (ROWS - 1) as f32;
        let k = if is_here { root as i32 } else { 0 };
        let part = (density * (STEPS * STEPS) as f32 - (k * k) as f32) / (2 * k + 1) as f32;
        let place = ((z + LIMIT as f32) * FINENESS as f32).max(0.0).min((NODES - 1) as f32);
        let i = (place as i32).min(NODES as i32 - 2);
        let t = place - i as f32;
        let value = |at: i32| self.values[at as u32 as usize % ALL];
        let node = |at: i32| value(at) + (value(at + 1) - value(at)) * t;
        let (a, b) = (node(k * ROW as i32 + i), node((k + 1) * ROW as i32 + i));
        if is_here { a + (b - a) * part } else { f32::NAN }
    }
}
