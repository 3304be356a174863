//! Table of the grainy density of a pixel over its mean density and its normal number, for pixels of one size.

use super::count::{Counts, FINENESS, LIMIT, NODES};
use rayon::prelude::*;

/// Samples per unit of the square root of the density, and number of samples: up to a density of 4.
const STEPS: usize = 512;
const ROWS: usize = 1024;

/// Length of a row, a power of 2 so that a shift finds it. The samples over the normal number are those of [`Counts`].
const ROW: usize = 512;
const ALL: usize = ROWS * ROW;

/// Grainy densities, row by row.
pub(super) struct Pixels {
    values: Box<[f32; ALL]>,
}

impl Pixels {
    /// Builds the table for pixels in which a grain has the density `one(density)`, 0 for no grain. `alone` is defined in
    /// [`Counts::evened`].
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

    /// Looks up the grainy density of a pixel of density `density` with the number `z`. Returns NaN if the density is not above 0 or beyond
    /// the last row, or if `z` lies beyond the nodes.
    ///
    /// Between two rows it is linear in the density, so that the mean over z stays.
    #[inline(always)]
    pub(super) fn at(&self, density: f32, z: f32) -> f32 {
        let root = density.sqrt() * STEPS as f32;
        let is_here = root > 0.0 && root < (ROWS - 1) as f32 && z.abs() <= LIMIT as f32;
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean over the normal number is the density, and the variance is the density times that of one grain: Poisson's law, by a sum
    /// over the normal distribution.
    #[test]
    fn grainy_densities_have_the_moments_of_poissons_law() {
        for one in [0.3_f64, 0.01, 2e-4] {
            let pixels = Pixels::new(Counts::all(), 1.0, |_| one as f32);
            for density in [0.02_f64, 0.3, 1.0, 2.7] {
                let (mut all, mut sum, mut squares) = (0.0, 0.0, 0.0);
                for k in -4990..=4990 {
                    let z = f64::from(k) / 1000.0;
                    let weight = (-0.5 * z * z).exp();
                    let got = f64::from(pixels.at(density as f32, z as f32));
                    (all, sum, squares) = (all + weight, sum + weight * got, squares + weight * got * got);
                }
                let (mean, grains) = (sum / all, density / one);
                let variance = squares / all - mean * mean;
                assert!((mean / density - 1.0).abs() < 2e-3, "{density} of {one}: {mean}");
                // Counts of few grains have extra variance between the nodes.
                let off = if grains < 2.0 { 0.2 } else { 0.03 };
                assert!((variance / (density * one) - 1.0).abs() < off, "{density} of {one}: {variance}");
            }
        }
    }

    #[test]
    fn what_is_beyond_the_table_is_no_number() {
        let pixels = Pixels::new(Counts::all(), 1.0, |_| 0.01);
        assert!(pixels.at(1.0, 4.9).is_finite());
        for (density, z) in
            [(0.0, 0.0), (-1.0, 0.0), (f32::NAN, 0.0), (4.1, 0.0), (1.0, 5.1), (1.0, -5.1), (1.0, f32::NAN)]
        {
            assert!(pixels.at(density, z).is_nan(), "{density} {z}");
        }
    }
}
