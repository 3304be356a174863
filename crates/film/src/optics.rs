//! What a developed film is printed, scanned or projected through: a lens, which keeps some of its fine detail.
//!
//! The lens blurs light that has passed the film, so its blur acts on transmittance: grain and edges lose the same. Its MTF is taken
//! as a Gaussian, exp(-ln 2 (f / f50)^2), which good lenses are close to down to a fifth of the contrast.

use crate::emulsion::per_octave;
use crate::lookup::{Lookup, octaves};
use rayon::prelude::*;
use spectra_core::math::exp;
use spectra_numerics::normal;
use std::f64::consts::{LN_2, LN_10, PI};

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
    /// Weights across and down, from the middle on; the middle alone where pixels are coarser than the blur.
    weights: [Vec<f32>; 2],
    through: Lookup,
    back: Lookup,
}

/// Deviations that a kernel reaches.
const REACH: f64 = 4.0;

/// Densities whose transmittance is tabulated, and steps; beyond, it is held.
const DENSITIES: (f64, f64) = (-1.0, 9.0);
const STEPS: usize = 1 << 16;

impl Optics {
    /// A lens that keeps half of the contrast at `mtf50` cycles/mm on the film, for pixels of `pitch_mm` across and down.
    ///
    /// # Panics
    /// If a value is not positive and finite.
    #[must_use]
    pub fn new(mtf50: f64, pitch_mm: [f64; 2]) -> Self {
        assert!([mtf50, pitch_mm[0], pitch_mm[1]].iter().all(|v| *v > 0.0 && v.is_finite()), "values above 0");
        // exp(-2 (pi s f)^2) is a half at f50.
        let deviation_mm = (LN_2 / 2.0).sqrt() / (PI * mtf50);
        let through = Lookup::new(DENSITIES.0, DENSITIES.1, STEPS, |d| exp(-LN_10 * d));
        let back = per_octave(|log10_transmittance| -log10_transmittance, 1.0);
        Self { weights: pitch_mm.map(|pitch| weights(deviation_mm / pitch)), through, back }
    }

    /// Whether pixels are fine enough for the lens to matter.
    #[must_use]
    pub fn is_felt(&self) -> bool {
        self.weights.iter().any(|w| w.len() > 1)
    }

    /// Passes a plane of densities (of silver, or amounts of dye) of `width` columns through the lens, in place. Beyond the frame
    /// its border goes on. Takes memory for one more plane.
    pub fn apply(&self, density: &mut [f32], width: usize) {
        if !self.is_felt() || density.is_empty() {
            return;
        }
        let [across, down] = &self.weights;
        let mut passed = vec![0.0_f32; density.len()];
        passed.par_chunks_mut(width).zip(density.par_chunks(width)).for_each_init(
            || vec![0.0_f32; width + 2 * (across.len() - 1)],
            |row, (to, from)| {
                let reach = across.len() - 1;
                for (light, d) in row[reach..].iter_mut().zip(from) {
                    *light = self.through.at(f64::from(*d)) as f32;
                }
                let (first, last) = (row[reach], row[reach + width - 1]);
                row[..reach].fill(first);
                row[reach + width..].fill(last);
                blur(to, across, |k, sign| if sign { &row[reach + k..] } else { &row[reach - k..] });
            },
        );
        let height = density.len() / width;
        density.par_chunks_mut(width).enumerate().for_each(|(y, to)| {
            blur(to, down, |k, sign| {
                let row = if sign { (y + k).min(height - 1) } else { y.saturating_sub(k) };
                &passed[row * width..]
            });
            to.iter_mut().for_each(|v| *v = self.back.at(octaves(*v)) as f32);
        });
    }
}

/// The weighted sum of lines around one: `line(k, after)` is the one `k` after or before it.
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

/// Weights of a Gaussian of `deviation` pixels. Each is the integral over a pixel, which adds a twelfth to the
/// variance; the Gaussian has so much less.
fn weights(deviation: f64) -> Vec<f32> {
    let variance = deviation * deviation - 1.0 / 12.0;
    if variance <= 0.0 {
        return vec![1.0];
    }
    let deviation = variance.sqrt();
    let radius = (REACH * deviation).ceil() as usize;
    let beyond = |i: usize| normal::below(-(i as f64 + 0.5) / deviation);
    let part = |i: usize| if i == 0 { 1.0 - 2.0 * beyond(0) } else { beyond(i - 1) - beyond(i) };
    let all = 1.0 - 2.0 * beyond(radius);
    (0..=radius).map(|i| (part(i) / all) as f32).collect()
}
