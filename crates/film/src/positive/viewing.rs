//! Light through a film to an eye: XYZ, and what a screen shows of it.

use super::Reach;
use crate::deposit::Deposit;
use crate::lookup::{Lookup, from_octaves, octaves};
use spectra_color::matrix::{Matrix, apply, product};
use spectra_color::{Adaptation, Gamut, RgbSpace, into_gamut};
use spectra_core::math::pow;
use spectra_core::spectral::BAND;
use spectra_spectrum::{Emission, Observer};

/// What is shown as white.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureWhite {
    /// The clear film or print: a picture as one looks at it.
    #[default]
    Film,
    /// The bare light: what the film holds back of it is seen.
    Lamp,
}

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
    /// Of a picture seen in the dark.
    surround: Option<Surround>,
}

/// What a dark surround does to a picture: it looks lighter and softer than the same in a lit room.
#[derive(Clone, Debug)]
struct Surround {
    /// Luminance to what it is multiplied by, over octaves.
    factor: Lookup,
}

/// Exponent of luminance by which a picture seen in a dark surround is shown on a screen in a lit one: the ratio of c, the
/// impact of the surround, 0.525 in the dark to 0.69 in an average surround (CIE 159:2004, CIECAM02, table 1). Chromaticities
/// stay, as in the system gamma of ITU-R BT.2100.
pub const DARK_TO_AVERAGE: f64 = 0.525 / 0.69;

/// Octaves under 1 and over 1 at which the surround is sampled, and steps an octave: within 2e-7 of the power.
const SURROUND_OCTAVES: (f64, f64) = (126.0 - 24.0, 126.0 + 4.0);
const SURROUND_STEPS: usize = 1024;

impl Surround {
    fn dark() -> Self {
        let (low, high) = SURROUND_OCTAVES;
        let steps = (high - low) as usize * SURROUND_STEPS;
        let factor = |o: f64| pow(from_octaves(o), DARK_TO_AVERAGE - 1.0);
        Self { factor: Lookup::new(low, high, steps, factor) }
    }

    #[inline(always)]
    fn factor(&self, luminance: f64) -> f64 {
        if luminance > 0.0 { self.factor.at(octaves(luminance as f32)) } else { 0.0 }
    }
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
        Some(Self { weights, white, to_rgb: to_rgb(white), black: 0.0, surround: None })
    }

    /// The same with an eye that takes a film of the XYZ `white` for white, as one does of a slide in the dark and of a
    /// print, and is adapted to it (CAT16); the luminance `black` and what is darker is shown as black.
    #[must_use]
    pub fn between(self, black: f64, white: [f64; 3]) -> Self {
        Self { black, white, to_rgb: to_rgb(white), ..self }
    }

    /// The same, seen in the dark, as projections are: shown with [`DARK_TO_AVERAGE`].
    #[must_use]
    pub fn in_the_dark(self) -> Self {
        Self { surround: Some(Surround::dark()), ..self }
    }

    /// The luminance, as a share of white over black, that is shown as `shown`, both in linear light.
    #[must_use]
    pub fn share_shown_as(&self, shown: f64) -> f64 {
        if self.surround.is_some() { pow(shown, 1.0 / DARK_TO_AVERAGE) } else { shown }
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
        self.shown_in(xyz, Reach::Screen)
    }

    /// The same, within its gamut or not.
    #[must_use]
    pub fn shown_in(&self, xyz: [f64; 3], reach: Reach) -> [f64; 3] {
        let rgb = apply(&self.to_rgb, self.seen(xyz));
        match reach {
            Reach::Screen => into_gamut(rgb, RgbSpace::srgb(), Gamut::Desaturate),
            Reach::Open => rgb,
        }
    }

    /// XYZ as an eye in an average surround would have to meet them to see the same: black taken off, the surround allowed
    /// for, white still [`Viewing::white`].
    #[must_use]
    #[inline]
    pub fn seen(&self, xyz: [f64; 3]) -> [f64; 3] {
        // Taken off as so much of white: black is a veil over the whole picture.
        let veil = self.black / self.white[1];
        let mut seen = xyz;
        for (v, white) in seen.iter_mut().zip(&self.white) {
            *v = (*v - veil * white) / (1.0 - veil);
        }
        if let Some(surround) = &self.surround {
            let factor = surround.factor(seen[1] / self.white[1]);
            seen.iter_mut().for_each(|v| *v *= factor);
        }
        seen
    }
}

/// From XYZ to linear sRGB for an eye adapted to `white`, which is shown as 1.
fn to_rgb(white: [f64; 3]) -> Matrix {
    let srgb = RgbSpace::srgb();
    let columns = [0, 1, 2].map(|i| srgb.from_xyz([0, 1, 2].map(|k| if k == i { 1.0 } else { 0.0 })));
    let from_xyz: Matrix = [0, 1, 2].map(|row| [0, 1, 2].map(|column| columns[column][row]));
    product(&from_xyz, &Adaptation::Cat16.matrix(white, srgb.white_xyz()))
}
