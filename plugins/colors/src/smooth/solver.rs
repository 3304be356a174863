//! Newton's method that solves for the coefficients of a color.

use super::daylight;
use super::reflectance::{Coefficients, place};
use spectra_color::{RgbSpace, chromaticity, matrix};
use spectra_core::Isa;
use spectra_core::isa::Vectorized;
use spectra_core::spectral::BAND;
use spectra_spectrum::Observer;
use std::array::from_fn;

/// Solver for the coefficients whose reflectance has a given color under D65.
pub(super) struct Solver {
    /// Linear sRGB per unit of reflectance, and the values of the quadratic's three functions, at each wavelength.
    points: Vec<([f64; 3], [f64; 3])>,
    isa: Isa,
}

/// Computes linear sRGB of a reflectance and its derivatives by the three coefficients. A fourth value, 0, pads each vector.
struct ComputeColor<'a> {
    points: &'a [([f64; 3], [f64; 3])],
    c: Coefficients,
}

/// Number of wavelengths processed side by side.
const ABREAST: usize = 32;

impl Vectorized for ComputeColor<'_> {
    type Output = [[f64; 4]; 4];
    #[inline(always)]
    fn run(self) -> [[f64; 4]; 4] {
        let Self { points, c } = self;
        let mut sums = [[0.0; 4]; 4];
        for points in points.chunks(ABREAST) {
            let (mut value, mut slope, mut x) = ([0.0_f64; ABREAST], [0.0_f64; ABREAST], [0.0_f64; ABREAST]);
            for (x, (_, functions)) in x.iter_mut().zip(points) {
                *x = c[0] * functions[0] + c[1] * functions[1] + c[2] * functions[2];
            }
            for i in 0..ABREAST {
                let root = 1.0 / (1.0 + x[i] * x[i]).sqrt();
                value[i] = 0.5 + 0.5 * x[i] * root;
                slope[i] = 0.5 * root * root * root;
            }
            for (k, (seen, functions)) in points.iter().enumerate() {
                let seen = [seen[0], seen[1], seen[2], 0.0];
                let of = [value[k], slope[k] * functions[0], slope[k] * functions[1], slope[k] * functions[2]];
                for j in 0..4 {
                    for i in 0..4 {
                        sums[j][i] += of[j] * seen[i];
                    }
                }
            }
        }
        sums
    }
}

impl Solver {
    pub(super) fn new() -> Self {
        let light = daylight();
        let observer = Observer::cie_1931_2deg();
        let xyz = observer.xyz(&light);
        // The space has the primaries of sRGB and the white of tabulated D65, so that a reflectance of 1 has RGB (1, 1, 1).
        let srgb = RgbSpace::srgb();
        let white = chromaticity(xyz).unwrap_or(srgb.white_xy);
        let space = RgbSpace::new("sRGB", srgb.primaries_xy, white, srgb.transfer);
        let functions = observer.on_grid(&BAND);
        let points = (0..BAND.count).zip(light.on_grid(&BAND)).map(|(i, power)| {
            let t = place(BAND.wavelength_nm(i));
            let seen = [0, 1, 2].map(|k| functions[k][i] * power * BAND.step_nm / xyz[1]);
            (space.from_xyz(seen), [1.0, t, 1.5 * t * t - 0.5])
        });
        Self { points: points.collect(), isa: Isa::detect() }
    }

    /// Returns the linear sRGB color of the reflectance and its derivatives by the coefficients (columns).
    pub(super) fn color(&self, c: Coefficients) -> ([f64; 3], matrix::Matrix) {
        let [rgb, by_coefficient @ ..] = self.isa.run(ComputeColor { points: &self.points, c });
        (from_fn(|i| rgb[i]), from_fn(|i| from_fn(|j| by_coefficient[j][i])))
    }

    /// Solves for the coefficients of the color `wanted` by Newton's method from `start`. Each step is halved until it comes nearer. The
    /// iteration ends when the distance between the colors is below `near`, or when no step comes nearer.
    pub(super) fn solve(&self, wanted: [f64; 3], start: Coefficients, near: f64) -> Coefficients {
        let distance = |rgb: [f64; 3]| rgb.iter().zip(wanted).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        let mut now = start;
        let (mut rgb, mut change) = self.color(now);
        // Convergence is quadratic: from a neighboring point of the table, three steps are enough.
        for _ in 0..40 {
            let off = distance(rgb);
            if off < near * near {
                break;
            }
            let step = matrix::apply(&matrix::inverse(&change), [0, 1, 2].map(|i| wanted[i] - rgb[i]));
            let mut share = 1.0;
            let better = loop {
                let next = [0, 1, 2].map(|i| now[i] + share * step[i]);
                let (color, slope) = self.color(next);
                if distance(color) < off {
                    break Some((next, color, slope));
                }
                share *= 0.5;
                if share < 1e-6 {
                    break None;
                }
            };
            match better {
                Some(next) => (now, rgb, change) = next,
                None => break,
            }
        }
        now
    }
}
