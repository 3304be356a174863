//! Round trip from a color to a spectrum and back to the color that an eye sees: measures the error of a color model.

use crate::rgb::{RgbSpace, from_u8};
use spectra_core::stage::ColorModel;
use spectra_spectrum::Observer;

/// Converts colors to the spectra of a model and back: the CIE 1931 observer sees the spectra, and the result is sRGB in which
/// the model's white has luminance 1.
pub struct RoundTrip<'a> {
    model: &'a dyn ColorModel,
    /// Luminance Y of the model's white.
    white: f64,
}

/// Color errors of a model over a grid of 8-bit colors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundTripErrors {
    /// Largest error of a channel, in code values of 0 to 255.
    pub largest: f64,
    /// Mean error of a channel, in code values of 0 to 255.
    pub mean: f64,
    /// The color with the largest error, 8 bits per channel.
    pub worst: [u8; 3],
    /// Result of the round trip of `worst`: code values of 0 to 255, clipped.
    pub worst_back: [f64; 3],
    /// Phantom green: the largest green code value, 0 to 255, in the result for a pure red.
    pub phantom_green: f64,
}

impl<'a> RoundTrip<'a> {
    /// Builds the round trip of a model; `None` if its white has no visible light.
    #[must_use]
    pub fn new(model: &'a dyn ColorModel) -> Option<Self> {
        let white = Observer::cie_1931_2deg().xyz_of_power(&model.spectrum([1.0; 3]))[1];
        (white > 0.0 && white.is_finite()).then_some(Self { model, white })
    }

    /// Returns the result of the round trip of `linear_srgb`, in linear sRGB; values are negative outside the gamut.
    #[must_use]
    pub fn linear(&self, linear_srgb: [f64; 3]) -> [f64; 3] {
        let xyz = Observer::cie_1931_2deg().xyz_of_power(&self.model.spectrum(linear_srgb));
        RgbSpace::srgb().from_xyz(xyz.map(|v| v / self.white))
    }

    /// Returns the result of the round trip of an 8-bit color as code values, 0 to 255: clipped as a screen clips, not rounded.
    #[must_use]
    pub fn code(&self, rgb: [u8; 3]) -> [f64; 3] {
        let srgb = RgbSpace::srgb();
        let back = srgb.encode(self.linear(srgb.decode(rgb.map(from_u8))));
        back.map(|v| 255.0 * v.clamp(0.0, 1.0))
    }

    /// Computes the errors over all 8-bit colors in steps of `step` per channel (1 to 255). The grid includes 255 only if `step` divides
    /// it.
    #[must_use]
    pub fn errors(&self, step: u8) -> RoundTripErrors {
        let levels = || (0..=255_u8).step_by(usize::from(step.max(1)));
        let mut errors =
            RoundTripErrors { largest: 0.0, mean: 0.0, worst: [0; 3], worst_back: [0.0; 3], phantom_green: 0.0 };
        let (mut sum, mut count) = (0.0, 0.0);
        for r in levels() {
            for g in levels() {
                for b in levels() {
                    let rgb = [r, g, b];
                    let back = self.code(rgb);
                    for (back_value, value) in back.iter().zip(rgb) {
                        let off = (back_value - f64::from(value)).abs();
                        sum += off;
                        count += 1.0;
                        if off > errors.largest {
                            (errors.largest, errors.worst, errors.worst_back) = (off, rgb, back);
                        }
                    }
                    if g == 0 && b == 0 {
                        errors.phantom_green = errors.phantom_green.max(back[1]);
                    }
                }
            }
        }
        RoundTripErrors { mean: sum / count, ..errors }
    }
}
