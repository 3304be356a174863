//! The lens through which a developed film is printed, scanned or projected, which loses some fine detail.
//!
//! The lens blurs light that has passed the film, so its blur acts on transmittance: grain and edges lose equally.
//! Its MTF is taken as a Gaussian, exp(-ln 2 (f / f50)^2), which is close to that of good lenses down to a fifth of the contrast.

use rayon::prelude::*;
use spectra_core::isa::{Isa, Vectorized};
use spectra_numerics::math::{exp2_single, log2_single};
use spectra_numerics::normal;
use std::f32::consts::{LOG2_10, LOG10_2};
use std::f64::consts::{LN_2, PI};

/// The lens between a film and its picture, for pixels of one size.
///
/// ```
/// use spectra_film::optics::Optics;
/// let lens = Optics::new(60.0, [0.003, 0.003]);
/// let mut density: Vec<f32> = (0..400).map(|k| if k % 20 < 10 { 1.0 } else { 0.2 }).collect();
/// lens.apply(&mut density, 20);
/// assert!(density[9] < 0.8 && density[10] > 0.3);
/// assert!((density[3] - 1.0).abs() < 1e-2);
/// ```
pub struct Optics {
    /// Weights across and down, from the center on; only the center if pixels are coarser than the blur.
    weights: [Vec<f32>; 2],
    isa: Isa,
}

/// Reach of a kernel, standard deviations.
const REACH: f64 = 4.0;

/// Range of densities that pass unchanged; others are clipped to it.
const DENSITIES: (f32, f32) = (-1.0, 9.0);

impl Optics {
    /// Prepares a lens that keeps half of the contrast at `mtf50` cycles/mm on the film, for pixels of `pitch_mm` across and down.
    ///
    /// # Panics
    /// If a value is not positive and finite.
    #[must_use]
    pub fn new(mtf50: f64, pitch_mm: [f64; 2]) -> Self {
        assert!([mtf50, pitch_mm[0], pitch_mm[1]].iter().all(|v| *v > 0.0 && v.is_finite()), "values above 0");
        // exp(-2 (pi s f)^2) is one half at f50.
        let deviation_mm = (LN_2 / 2.0).sqrt() / (PI * mtf50);
        Self { weights: pitch_mm.map(|pitch| weights(deviation_mm / pitch)), isa: Isa::detect() }
    }

    /// Returns whether the pixels are fine enough for the blur of the lens to show.
    #[must_use]
    pub fn is_felt(&self) -> bool {
        self.weights.iter().any(|w| w.len() > 1)
    }

    /// Blurs a plane of densities (of silver, or amounts of dye) with `width` columns by the lens, in place. Border pixels continue outside
    /// the frame. Needs memory for one more plane.
    pub fn apply(&self, density: &mut [f32], width: usize) {
        if !self.is_felt() || density.is_empty() {
            return;
        }
        let mut passed = vec![0.0_f32; density.len()];
        self.pass(density, width, &mut passed);
    }

    /// Blurs several planes of one size as [`Optics::apply`] does, with memory for one more plane.
    pub fn apply_to_all(&self, planes: &mut [Vec<f32>], width: usize) {
        let Some(pixels) = planes.first().map(Vec::len).filter(|pixels| self.is_felt() && *pixels > 0) else { return };
        let mut passed = vec![0.0_f32; pixels];
        planes.iter_mut().for_each(|plane| self.pass(plane, width, &mut passed));
    }

    fn pass(&self, density: &mut [f32], width: usize, passed: &mut [f32]) {
        let [across, down] = &self.weights;
        passed.par_chunks_mut(width).zip(density.par_chunks(width)).for_each_init(
            || vec![0.0_f32; width + 2 * (across.len() - 1)],
            |row, (to, from)| self.isa.run(Across { weights: across, row, from, to }),
        );
        let passed = &*passed;
        density.par_chunks_mut(width).enumerate().for_each(|(y, to)| {
            self.isa.run(Down { weights: down, passed, y, to });
        });
    }
}

/// Converts a row of densities to light and blurs it along the row.
struct Across<'a> {
    weights: &'a [f32],
    row: &'a mut [f32],
    from: &'a [f32],
    to: &'a mut [f32],
}

impl Vectorized for Across<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { weights, row, from, to } = self;
        let (reach, width) = (weights.len() - 1, to.len());
        for (light, d) in row[reach..].iter_mut().zip(from) {
            *light = exp2_single(-LOG2_10 * d.max(DENSITIES.0).min(DENSITIES.1));
        }
        let (first, last) = (row[reach], row[reach + width - 1]);
        row[..reach].fill(first);
        row[reach + width..].fill(last);
        blur(to, weights, |k, after| if after { &row[reach + k..] } else { &row[reach - k..] });
    }
}

/// Blurs the rows of light around the row `y` and converts them back to densities.
struct Down<'a> {
    weights: &'a [f32],
    passed: &'a [f32],
    y: usize,
    to: &'a mut [f32],
}

impl Vectorized for Down<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { weights, passed, y, to } = self;
        let width = to.len();
        let last = passed.len() / width - 1;
        blur(to, weights, |k, after| &passed[if after { (y + k).min(last) } else { y.saturating_sub(k) } * width..]);
        to.iter_mut().for_each(|v| *v = -LOG10_2 * log2_single(*v));
    }
}

/// Computes the weighted sum of lines around one: `line(k, after)` is the line `k` after or before it.
#[inline(always)]
fn blur<'a>(to: &mut [f32], weights: &[f32], line: impl Fn(usize, bool) -> &'a [f32]) {
    for (to, v) in to.iter_mut().zip(line(0, true)) {
        *to = weights[0] * v;
    }
    for (k, weight) in weights.iter().enumerate().skip(1) {
        for ((to, a), b) in to.iter_mut().zip(line(k, true)).zip(line(k, false)) {
            *to += weight * (a + b);
        }
    }
}

/// Weights of a Gaussian of `deviation` pixels. Each is an integral over a pixel, which adds a twelfth to the variance; the Gaussian is
/// narrowed accordingly.
fn weights(deviation: f64) -> Vec<f32> {
    let variance = deviation * deviation - 1.0 / 12.0;
    if variance <= 0.0 {
        return vec![1.0];
    }
    let deviation = variance.sqrt();
    let radius = (REACH * deviation).ceil() as usize;
    let beyond = |i: usize| normal::cdf(-(i as f64 + 0.5) / deviation);
    let part = |i: usize| if i == 0 { 1.0 - 2.0 * beyond(0) } else { beyond(i - 1) - beyond(i) };
    let all = 1.0 - 2.0 * beyond(radius);
    (0..=radius).map(|i| (part(i) / all) as f32).collect()
}
