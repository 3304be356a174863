//! Viewing: light through a film to an eye, as XYZ and as a screen shows it.

use super::GamutLimit;
use super::frame::ROW;
use crate::deposit::Deposit;
use crate::viewing_options::{FLARE, Surround};
use spectra_color::matrix::{Matrix, apply, product};
use spectra_color::{Adaptation, Gamut, RgbSpace, into_gamut};
use spectra_core::math::{exp2_single, log2_single, pow};
use spectra_core::spectral::BAND;
use spectra_spectrum::{Emission, Observer};
use std::f32::consts::LOG2_10;

/// Returns the power of a light at the points of the band; a spectral line is split between its two neighbors.
#[must_use]
pub fn on_band(light: &Emission) -> Vec<f64> {
    let power = light.to_power(&BAND);
    let mut all = power.continuum;
    for line in power.lines.iter().filter(|l| BAND.contains(l.wavelength_nm)) {
        let p = (line.wavelength_nm - BAND.start_nm) / BAND.step_nm;
        let i = (p as usize).min(BAND.count - 2);
        all[i] += line.power * (i as f64 + 1.0 - p);
        all[i + 1] += line.power * (p - i as f64);
    }
    all
}

/// Viewing conditions of a film or print, for an eye adapted to its white.
#[derive(Clone, Debug)]
pub struct Viewing {
    /// CIE 1931 functions times the light, so that Y of the bare light is 1.
    weights: Vec<Vec<f64>>,
    /// XYZ of white, relative to the bare light.
    white: [f64; 3],
    to_rgb: Matrix,
    /// Luminance of black, relative to the bare light.
    black: f64,
    /// Additional light reflected by the surface, as a fraction of white.
    flare: f64,
    surround: Surround,
}

/// Range of luminances over which the exponent of [`Surround`] applies; outside it, the factor at the nearer end is used.
const SURROUND: (f64, f64) = (1.0 / (1 << 24) as f64, 16.0);

impl Viewing {
    /// Prepares viewing in this light; `None` if the light is invisible. The bare light is shown as white, no light as black.
    #[must_use]
    pub fn by(light: &Emission) -> Option<Self> {
        let power = on_band(light);
        let functions = Observer::cie_1931_2deg().on_grid(&BAND);
        let sum: f64 = functions[1].iter().zip(&power).map(|(y, p)| y * p).sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return None;
        }
        let weights: Vec<Vec<f64>> =
            functions.iter().map(|f| f.iter().zip(&power).map(|(f, p)| f * p / sum).collect()).collect();
        let white = [0, 1, 2].map(|i| weights[i].iter().sum());
        Some(Self { weights, white, to_rgb: to_rgb(white), black: 0.0, flare: 0.0, surround: Surround::Average })
    }

    /// Returns these viewing conditions with another black and white. The eye takes a film whose XYZ is `white` for white and is
    /// adapted to it (CAT16), as for a slide in the dark or a print. Luminances up to `black` are shown as black.
    #[must_use]
    pub fn between(self, black: f64, white: [f64; 3]) -> Self {
        Self { black, white, to_rgb: to_rgb(white), ..self }
    }

    /// Returns these viewing conditions with another surround.
    #[must_use]
    pub fn surrounded(self, surround: Surround) -> Self {
        Self { surround, ..self }
    }

    /// Returns these viewing conditions for a surface that also reflects [`FLARE`] of the room's light.
    #[must_use]
    pub fn with_flare(self) -> Self {
        Self { flare: FLARE, ..self }
    }

    /// Finds the luminance that is shown as `shown` (linear light; white is 1). The result is 0 at the black of these viewing
    /// conditions and 1 at their white.
    #[must_use]
    pub fn share_shown_as(&self, shown: f64) -> f64 {
        pow(shown, 1.0 / self.surround.exponent()) * (1.0 + self.flare) - self.flare
    }

    /// Factor for XYZ, and fraction of white that is then added. Black is a veil over the whole picture, so it is subtracted as a fraction
    /// of white; flare is added.
    fn scale(&self) -> (f64, f64) {
        let veil = self.black / self.white[1];
        let times = 1.0 / ((1.0 - veil) * (1.0 + self.flare));
        (times, self.flare / (1.0 + self.flare) - veil * times)
    }

    /// Weights that turn transmittances into XYZ: one spectrum each for X, Y and Z, sampled at the wavelengths of [`BAND`].
    #[must_use]
    pub fn weights(&self) -> &[Vec<f64>] {
        &self.weights
    }

    /// XYZ of white, relative to the bare light.
    #[must_use]
    pub fn white(&self) -> [f64; 3] {
        self.white
    }

    /// Computes XYZ of a film with these amounts, relative to the bare light.
    #[must_use]
    pub fn xyz(&self, deposit: &Deposit, amounts: &[f64]) -> [f64; 3] {
        let seen = deposit.receiver_sums(amounts, &self.weights);
        [seen[0], seen[1], seen[2]]
    }

    /// Luminance of black, relative to the bare light.
    #[must_use]
    pub fn black(&self) -> f64 {
        self.black
    }

    /// Converts XYZ, relative to the bare light, to what the screen shows: linear light, sRGB primaries, within its gamut.
    #[must_use]
    pub fn to_screen(&self, xyz: [f64; 3]) -> [f64; 3] {
        self.shown_in(xyz, GamutLimit::Screen)
    }

    /// Converts XYZ, relative to the bare light, to linear light in sRGB primaries. `reach` limits the result to the gamut of the
    /// screen or leaves it open.
    #[must_use]
    pub fn shown_in(&self, xyz: [f64; 3], reach: GamutLimit) -> [f64; 3] {
        let rgb = apply(&self.to_rgb, self.corrected_for_surround(xyz));
        match reach {
            GamutLimit::Screen => into_gamut(rgb, RgbSpace::srgb(), Gamut::Desaturate),
            GamutLimit::Open => rgb,
        }
    }

    /// Converts XYZ to the values that would look the same in an average surround: subtracts black, adds flare, and corrects for the
    /// surround. White stays [`Viewing::white`].
    #[must_use]
    #[inline]
    pub fn corrected_for_surround(&self, xyz: [f64; 3]) -> [f64; 3] {
        let (times, added) = self.scale();
        let mut seen = xyz;
        for (v, white) in seen.iter_mut().zip(&self.white) {
            *v = *v * times + added * white;
        }
        if self.surround != Surround::Average {
            let luminance = seen[1] / self.white[1];
            let held = luminance.clamp(SURROUND.0, SURROUND.1);
            let factor = if luminance > 0.0 { pow(held, self.surround.exponent() - 1.0) } else { 0.0 };
            seen.iter_mut().for_each(|v| *v *= factor);
        }
        seen
    }
}

impl Viewing {
    /// Computes [`Viewing::shown_in`] for a row of places whose XYZ densities are `row`, which is overwritten.
    #[inline(always)]
    pub(super) fn shown_row(&self, row: &mut [[f32; ROW]; 3], reach: GamutLimit, to: &mut [[f32; 3]]) {
        let (times, added) = self.scale();
        let (times, added) = (times as f32, self.white.map(|white| (added * white) as f32));
        let exponent = (self.surround.exponent() - 1.0) as f32;
        let per_white = (1.0 / self.white[1]) as f32;
        let matrix = self.to_rgb.map(|row| row.map(|v| v as f32));
        let luminance =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|v| RgbSpace::srgb().luminance(v) as f32);
        let (least, most) = (SURROUND.0 as f32, SURROUND.1 as f32);
        let [x, y, z] = row;
        for ((x, y), z) in x.iter_mut().zip(y.iter_mut()).zip(z.iter_mut()) {
            let light = |d: f32, added: f32| exp2_single(-LOG2_10 * d) * times + added;
            let mut seen = [light(*x, added[0]), light(*y, added[1]), light(*z, added[2])];
            if self.surround != Surround::Average {
                let y = seen[1] * per_white;
                let held = y.max(least).min(most);
                let factor = exp2_single(log2_single(held) * exponent);
                let factor = if y > 0.0 { factor } else { 0.0 };
                seen = [seen[0] * factor, seen[1] * factor, seen[2] * factor];
            }
            let rgb = |m: [f32; 3]| m[0] * seen[0] + m[1] * seen[1] + m[2] * seen[2];
            (*x, *y, *z) = (rgb(matrix[0]), rgb(matrix[1]), rgb(matrix[2]));
            if reach == GamutLimit::Screen {
                // Desaturates as `spectra_color::into_gamut` does: toward the gray of its luminance, by the largest share of color that
                // fits.
                let gray = luminance[0] * *x + luminance[1] * *y + luminance[2] * *z;
                let gray = gray.clamp(0.0, 1.0);
                let share = |v: f32| {
                    let room = if v > gray { 1.0 - gray } else { gray };
                    let far = (v - gray).abs();
                    if far > room { room / far } else { 1.0 }
                };
                let share = share(*x).min(share(*y)).min(share(*z));
                let within = |v: f32| (gray + share * (v - gray)).clamp(0.0, 1.0);
                (*x, *y, *z) = (within(*x), within(*y), within(*z));
            }
        }
        for (i, to) in to.iter_mut().enumerate() {
            *to = [x[i], y[i], z[i]];
        }
    }
}

/// Matrix from XYZ to linear sRGB for an eye adapted to `white`, which becomes 1.
fn to_rgb(white: [f64; 3]) -> Matrix {
    let srgb = RgbSpace::srgb();
    let columns = [0, 1, 2].map(|i| srgb.from_xyz([0, 1, 2].map(|k| if k == i { 1.0 } else { 0.0 })));
    let from_xyz: Matrix = [0, 1, 2].map(|row| [0, 1, 2].map(|column| columns[column][row]));
    product(&from_xyz, &Adaptation::Cat16.matrix(white, srgb.white_xyz()))
}
