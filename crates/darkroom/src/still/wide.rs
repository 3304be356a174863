//! Table of the channels' exposures by colors beyond sRGB.

use super::{Colors, JUDGES};
use rayon::prelude::*;
use spectra_color::RealGamut;
use spectra_core::stage::ColorGamut;

/// Number of directions from white.
const DIRECTIONS: usize = 1440;
/// Number of points in each direction, denser toward the spectral locus.
const ROWS: usize = 65;

/// A table over the direction from white, and the depth between sRGB and the boundary of real colors.
pub(super) struct Wide {
    real: RealGamut,
    /// Exposures of the channels by the color whose largest value is 1, for each direction and row.
    points: Vec<f32>,
    channels: usize,
}

/// Returns the depth of a row, from 0 to 1.
fn depth(row: usize) -> f64 {
    let left = 1.0 - row as f64 / (ROWS - 1) as f64;
    1.0 - left * left
}

impl Wide {
    /// Computes the table; `None` if the color model makes no spectra beyond sRGB.
    pub(super) fn new(colors: &Colors<'_>) -> Option<Self> {
        if colors.model.gamut() == ColorGamut::Srgb {
            return None;
        }
        let real = RealGamut::even(DIRECTIONS);
        let column = |turn: &f64| -> Vec<f32> {
            let of = |row| colors.integrals(RealGamut::color(*turn, depth(row)));
            (0..ROWS).flat_map(of).map(|v| v as f32).collect()
        };
        let points = real.turns().par_iter().flat_map_iter(column).collect();
        Some(Self { real, points, channels: colors.channels.len() })
    }

    /// Returns the largest error of the table against integrals, over colors of all directions and depths.
    pub(super) fn worst(&self, colors: &Colors<'_>) -> f64 {
        let off = |i: usize| {
            // Additive recurrences with irrational steps fill a square evenly (the plastic number).
            let at = |step: f64| (0.5 + i as f64 * step).fract();
            let color = RealGamut::color(4.0 * at(0.754_877_666_246_692_7), at(0.569_840_290_998_053_3));
            let color = color.map(|v| v as f32);
            let mut found = vec![0.0; self.channels];
            if self.at(color, &mut found) { colors.off(color, &found) } else { 0.0 }
        };
        (0..JUDGES).into_par_iter().map(off).reduce(|| 0.0, f64::max)
    }

    /// Looks up the exposure of each channel by a color with a negative value. Returns whether the color has any luminance.
    pub(super) fn at(&self, rgb: [f32; 3], to: &mut [f32]) -> bool {
        let Some(place) = self.real.place(rgb.map(f64::from)) else { return false };
        let row = (((1.0 - (1.0 - place.depth).sqrt()) * (ROWS - 1) as f64) as usize).min(ROWS - 2);
        let (low, high) = (depth(row), depth(row + 1));
        let down = ((place.depth - low) / (high - low)).clamp(0.0, 1.0);
        let first = (place.direction * ROWS + row) * self.channels;
        let (left, right) = (&self.points[first..], &self.points[first + ROWS * self.channels..]);
        for (k, to) in to.iter_mut().enumerate() {
            let between = |points: &[f32]| {
                let [a, b] = [points[k], points[self.channels + k]].map(f64::from);
                a + (b - a) * down
            };
            let (a, b) = (between(left), between(right));
            *to = (place.peak * (a + (b - a) * place.fraction)) as f32;
        }
        true
    }
}
