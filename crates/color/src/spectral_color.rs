//! Screen colors of single wavelengths.

use crate::rgb::{RgbSpace, to_u8};
use spectra_spectrum::Observer;

/// Computes linear RGB of monochromatic light: the CIE 1931 color matching functions in `space`, scaled so that the largest
/// channel is 1. Negative channels are 0. The result is black if the observer sees no light.
///
/// The color keeps the hue but not the true intensity. Multiply by the luminous efficiency if that matters.
#[must_use]
pub fn spectral_color_linear(wavelength_nm: f64, space: &RgbSpace) -> [f64; 3] {
    let rgb = space.from_xyz(Observer::cie_1931_2deg().at(wavelength_nm)).map(|v| v.max(0.0));
    let brightest = rgb[0].max(rgb[1]).max(rgb[2]);
    if brightest > 0.0 { rgb.map(|v| v / brightest) } else { [0.0; 3] }
}

/// Computes code values of monochromatic light for a picture file: [`spectral_color_linear`] with the transfer curve of `space`.
#[must_use]
pub fn spectral_color_encoded(wavelength_nm: f64, space: &RgbSpace) -> [f64; 3] {
    space.encode(spectral_color_linear(wavelength_nm, space))
}

/// Computes the 8-bit sRGB code values of monochromatic light, as a screen shows it.
#[must_use]
pub fn spectral_color_srgb8(wavelength_nm: f64) -> [u8; 3] {
    spectral_color_encoded(wavelength_nm, RgbSpace::srgb()).map(to_u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with an independent computation from the CIE 1931 functions. The linear column is the table of a published dispersion
    /// study, which took linear values for what a screen shows.
    #[test]
    fn spectral_colors() {
        for (nm, linear, shown) in [
            (436.0, [33, 0, 255], [101, 0, 255]),
            (547.0, [0, 255, 0], [0, 255, 0]),
            (577.0, [255, 148, 0], [255, 200, 0]),
            (579.0, [255, 126, 0], [255, 187, 0]),
            (620.0, [255, 0, 0], [255, 0, 0]),
        ] {
            let got = spectral_color_linear(nm, RgbSpace::srgb()).map(to_u8);
            let on_screen = spectral_color_srgb8(nm);
            for i in 0..3 {
                assert!(got[i].abs_diff(linear[i]) <= 1, "{nm}: {got:?}");
                assert!(on_screen[i].abs_diff(shown[i]) <= 1, "{nm}: {on_screen:?}");
            }
        }
    }

    #[test]
    fn invisible_light_is_black() {
        assert_eq!(spectral_color_linear(f64::NAN, RgbSpace::srgb()), [0.0; 3]);
    }
}
