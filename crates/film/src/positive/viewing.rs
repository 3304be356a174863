//! Light through a film to an eye: XYZ, and what a screen shows of it.

use crate::deposit::Deposit;
use spectra_color::matrix::{Matrix, apply, product};
use spectra_color::{Adaptation, Gamut, RgbSpace, into_gamut};
use spectra_core::spectral::BAND;
use spectra_spectrum::{Emission, Observer};

/// Power of a light on the points of the band; a line is split between its two neighbors.
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

/// A film looked at in transmitted light, by an eye adapted to the whitest there is.
#[derive(Clone, Debug)]
pub struct Viewing {
    /// CIE 1931 functions times the light, so that Y of the bare light is 1.
    weights: Vec<Vec<f64>>,
    /// XYZ of what is taken for white.
    white: [f64; 3],
    to_rgb: Matrix,
    /// Luminance of what is taken for black, relative to the bare light.
    black: f64,
}

impl Viewing {
    /// In this light; `None` where it is dark to the eye. The bare light is shown as white, no light as black.
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
        Some(Self { weights, white, to_rgb: to_rgb(white), black: 0.0 })
    }

    /// The same with an eye that takes a film of the XYZ `white` for white, as one does of a slide in the dark and of a
    /// print, and is adapted to it (CAT16); the luminance `black` and what is darker is shown as black.
    #[must_use]
    pub fn between(self, black: f64, white: [f64; 3]) -> Self {
        Self { black, white, to_rgb: to_rgb(white), ..self }
    }

    /// What weighs transmittances into XYZ.
    #[must_use]
    pub fn weights(&self) -> &[Vec<f64>] {
        &self.weights
    }

    /// XYZ of what is taken for white, relative to the bare light.
    #[must_use]
    pub fn white(&self) -> [f64; 3] {
        self.white
    }

    /// XYZ of a film with these amounts, relative to the bare light.
    #[must_use]
    pub fn xyz(&self, deposit: &Deposit, amounts: &[f64]) -> [f64; 3] {
        let seen = deposit.seen(amounts, &self.weights);
        [seen[0], seen[1], seen[2]]
    }

    /// Luminance of what is taken for black.
    #[must_use]
    pub fn black(&self) -> f64 {
        self.black
    }

    /// What the screen shows of XYZ: linear light, sRGB primaries, within its gamut.
    #[must_use]
    pub fn shown(&self, xyz: [f64; 3]) -> [f64; 3] {
        // Taken off as so much of white: black is a veil over the whole picture.
        let veil = self.black / self.white[1];
        let seen = [0, 1, 2].map(|i| (xyz[i] - veil * self.white[i]) / (1.0 - veil));
        into_gamut(apply(&self.to_rgb, seen), RgbSpace::srgb(), Gamut::Desaturate)
    }
}

/// From XYZ to linear sRGB for an eye adapted to `white`, which is shown as 1.
fn to_rgb(white: [f64; 3]) -> Matrix {
    let srgb = RgbSpace::srgb();
    let columns = [0, 1, 2].map(|i| srgb.from_xyz([0, 1, 2].map(|k| if k == i { 1.0 } else { 0.0 })));
    let from_xyz: Matrix = [0, 1, 2].map(|row| [0, 1, 2].map(|column| columns[column][row]));
    product(&from_xyz, &Adaptation::Cat16.matrix(white, srgb.white_xyz()))
}
