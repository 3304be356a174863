//! Spreads a unit of light in one pixel over the pixels around it.
//!
//! If pixels are finer than a fringe, each sample of the pattern reaches them through a windowed sinc and not through a pixel's own box:
//! the traced light was already summed over that box. No pixel gets a negative weight. The middle pixel gets what the others leave of 1, so
//! the energy is exact.

use crate::aberrated::{Correction, correction};
use crate::channel_light::ChannelLight;
use crate::{Polygon, Wavefront, Wings};
use spectra_core::math;
use std::f64::consts::{PI, TAU};

/// Distance up to which the pattern itself is integrated, in fringes (wavelengths times f-number); beyond it the average effect of the
/// edges is used.
const FRINGES: f64 = 16.0;
/// Number of samples of the pattern in its finest fringe.
const SAMPLES: f64 = 3.0;
/// Reach of the window that keeps fine patterns sharp, in pixels.
const WINDOW: f64 = 6.0;

/// The weights with which a pixel's light is spread over the pixels around it, point-symmetric about it.
#[derive(Clone, Debug)]
pub struct PixelSpread {
    radius: usize,
    weights: Vec<f64>,
}

impl PixelSpread {
    /// Computes the spread of a channel's light by an opening (in direction cosines). `pitch_mm` is the size of a pixel, mm. The
    /// weights reach out to `radius` pixels, where they fade out. `elsewhere` is the fraction of the light that goes farther. The
    /// weights and `elsewhere` sum to 1.
    #[must_use]
    pub fn new(opening: &Polygon, light: &ChannelLight, pitch_mm: [f64; 2], radius: usize, elsewhere: f64) -> Self {
        let wings = Wings::new(opening);
        let mut own = Self { radius, weights: vec![0.0; (2 * radius + 1) * (2 * radius + 1)] };
        let far_mm = radius as f64 * pitch_mm[0].min(pitch_mm[1]);
        let near_mm = near_mm(opening, light);
        let is_near = |x: f64, y: f64| x * x + y * y <= near_mm * near_mm;
        let r = radius as isize;
        let colors = light.coarse();
        for j in 0..r + 1 {
            for i in -r..r + 1 {
                // Columns count opposite to x.
                let (x, y) = (-i as f64 * pitch_mm[0], j as f64 * pitch_mm[1]);
                let stays = 1.0 - fade((x * x + y * y).sqrt(), far_mm);
                if (j == 0 && i < 1) || is_near(x, y) || stays <= 0.0 {
                    continue;
                }
                let half = pitch_mm.map(|p| 0.5 * p);
                let of = |[mm, share]: &[f64; 2]| share * wings.intensity([x, y], half, *mm, false);
                own.set(i, j, stays * pitch_mm[0] * pitch_mm[1] * colors.iter().map(of).sum::<f64>());
            }
        }
        if near_mm >= pitch_mm[0].min(pitch_mm[1]) {
            own.add_near(opening, light, pitch_mm, near_mm, far_mm);
        }
        own.set(0, 0, 0.0);
        let all: f64 = own.weights.iter().sum();
        own.set(0, 0, 1.0 - all - elsewhere);
        own
    }

    /// Radius of the spread, pixels.
    #[must_use]
    pub fn radius(&self) -> usize {
        self.radius
    }

    /// Returns the weight of the pixel `i` to the right and `j` down from the center.
    #[must_use]
    pub fn weight(&self, i: isize, j: isize) -> f64 {
        let r = self.radius as isize;
        self.weights[((j + r) * (2 * r + 1) + i + r) as usize]
    }

    /// Corrects the weights for the aberrations of `wave`. Traced rays with these aberrations, spread by the corrected weights,
    /// have the contrast of the aberrated wavefront. `pitch_mm` is the size of a pixel, mm.
    ///
    /// Leaves the weights unchanged if the correction is negligible, or if the aberrations are so large that rays alone describe
    /// the light.
    #[must_use]
    pub fn with_wave(mut self, opening: &Polygon, wave: &Wavefront, light: &ChannelLight, pitch_mm: [f64; 2]) -> Self {
        if let Some(Correction { reach, weights }) = correction(opening, wave, light, pitch_mm) {
            let r = reach as isize;
            let places = (-r..r + 1).flat_map(|j| (-r..r + 1).map(move |i| [i, j]));
            for ([i, j], weight) in places.zip(weights).filter(|([i, j], _)| *j > 0 || (*j == 0 && *i >= 0)) {
                if i.unsigned_abs().max(j.unsigned_abs()) <= self.radius {
                    self.set(i, j, self.weight(i, j) + weight);
                }
            }
        }
        self
    }

    fn set(&mut self, i: isize, j: isize, weight: f64) {
        let r = self.radius as isize;
        for [i, j] in [[i, j], [-i, -j]] {
            self.weights[((j + r) * (2 * r + 1) + i + r) as usize] = weight;
        }
    }

    /// Samples the pattern itself and distributes it to the pixels near the middle.
    fn add_near(&mut self, opening: &Polygon, light: &ChannelLight, pitch_mm: [f64; 2], near_mm: f64, far_mm: f64) {
        let [shortest, longest] = light.range_mm();
        let across = 2.0 * opening.reach();
        let pitch = pitch_mm[0].min(pitch_mm[1]);
        let widest = pitch_mm[0].max(pitch_mm[1]);
        // Step in cycles per unit of direction cosine: length on film over wavelength.
        let step = (1.0 / (SAMPLES * across)).min(0.4 * pitch / longest);
        // Patterns much finer than pixels need no window: the boxes of the pixels collect all of them.
        let sharp = pitch < light.mean_mm() / across;
        let room = if sharp { WINDOW } else { 0.75 };
        let samples = ((near_mm + room * widest) / shortest / step).ceil() as isize;
        let side = 2 * samples as usize + 1;
        let mut pattern = vec![0.0; side * side];
        // The simplified corners change no phase by more than a thousandth.
        let simple = opening.simplified(1e-3 / (TAU * step * samples as f64));
        for (k, value) in simple.lattice(TAU * step, samples as usize).into_iter().enumerate() {
            // Columns count opposite to x.
            let (i, j) = (side - 1 - k % side, k / side);
            pattern[(samples as usize + j) * side + i] = value;
            pattern[(samples as usize - j) * side + side - 1 - i] = value;
        }
        let per_sample = opening.area() * step * step;
        let reach = ((near_mm / pitch).ceil() as usize + 1).min(self.radius);
        let pixels = 2 * reach + 1;
        let mut sums = [vec![0.0; pixels * pixels], vec![0.0; pixels * pixels]];
        for [mm, share] in light.shares() {
            for (kind, sum) in sums.iter_mut().enumerate().take(1 + usize::from(sharp)) {
                // The shares of each sample that the pixels of a line get.
                let taps = |pitch: f64| -> Vec<Vec<(usize, f64)>> {
                    let size = step * mm / pitch;
                    (-samples..samples + 1).map(|i| taps(i as f64 * size, size, reach, kind == 1)).collect()
                };
                let [columns, rows] = pitch_mm.map(taps);
                let mut line = vec![0.0; pixels];
                for (j, taps) in rows.iter().enumerate().filter(|(_, taps)| !taps.is_empty()) {
                    line.fill(0.0);
                    for (value, taps) in pattern[j * side..][..side].iter().zip(&columns) {
                        taps.iter().for_each(|(at, part)| line[*at] += value * part);
                    }
                    for (row, part) in taps {
                        let factor = share * per_sample * part;
                        sum[row * pixels..][..pixels].iter_mut().zip(&line).for_each(|(to, v)| *to += factor * v);
                    }
                }
            }
        }
        let [boxed, windowed] = sums;
        let places = |k: usize| [(k % pixels) as isize - reach as isize, (k / pixels) as isize - reach as isize];
        let distance = |[i, j]: [isize; 2]| {
            let (x, y) = (i as f64 * pitch_mm[0], j as f64 * pitch_mm[1]);
            (x * x + y * y).sqrt()
        };
        for (k, a) in boxed.iter().enumerate() {
            let [i, j] = places(k);
            let r = distance([i, j]);
            if r <= near_mm && (j > 0 || (j == 0 && i > 0)) {
                // No pixel gets a negative weight, or less than 2 % of what its own box gets.
                let own = if sharp { windowed[k].max(0.02 * a) } else { *a };
                self.set(i, j, (1.0 - fade(r, far_mm)) * own);
            }
        }
    }
}

/// Returns the distance up to which the pattern itself is integrated, mm.
pub(crate) fn near_mm(opening: &Polygon, light: &ChannelLight) -> f64 {
    FRINGES * light.range_mm()[1] / (2.0 * opening.reach())
}

/// Returns the fraction of the light at distance `r` that no longer goes to the pixels around: 0 up to 0.6 of `end`, from there
/// increasing to 1 at `end`, and 1 beyond.
pub(crate) fn fade(r: f64, end: f64) -> f64 {
    let t = ((r / end - 0.6) / 0.4).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Returns the shares of a sample, of this size around `at` (in pixels), for the pixels up to `reach`.
fn taps(at: f64, size: f64, reach: usize, sharp: bool) -> Vec<(usize, f64)> {
    let end = reach as f64;
    let pixel = |k: f64| (k + end) as usize;
    let (low, high) = (at - 0.5 * size, at + 0.5 * size);
    let around =
        if sharp { [(at - WINDOW).ceil(), (at + WINDOW).floor()] } else { [(low + 0.5).floor(), (high + 0.5).floor()] };
    let mut taps = Vec::new();
    let mut k = around[0].max(-end);
    while k <= around[1].min(end) {
        let part = if sharp { window(at - k) } else { ((high.min(k + 0.5) - low.max(k - 0.5)) / size).max(0.0) };
        if part != 0.0 {
            taps.push((pixel(k), part));
        }
        k += 1.0;
    }
    taps
}

/// A windowed sinc that ends at [`WINDOW`]: 1 at its own pixel, 0 at all others (C. E. Duchon, "Lanczos filtering in one and two
/// dimensions", J. Appl. Meteorol. 18, 1979).
fn window(x: f64) -> f64 {
    let sinc = |x: f64| if x.abs() < 1e-9 { 1.0 } else { math::sin(PI * x) / (PI * x) };
    if x.abs() >= WINDOW { 0.0 } else { sinc(x) * sinc(x / WINDOW) }
}
