//! Figures of spectra, their colors, and glasses.

mod abbe;
mod chromaticity;
mod dispersion;
mod glass_fit;
mod lamp;
mod spectrum;
mod swatches;

pub use abbe::{AbbeGroup, abbe};
pub use chromaticity::{Diagram, chromaticity, chromaticity_diagram};
pub use dispersion::{IndexCurve, dispersion};
pub use glass_fit::{FittedCurve, glass_fit};
pub use lamp::{Patch as LampPatch, lamp};
pub use spectrum::{spectrum, spectrum_and_functions};
pub use swatches::swatches;

use spectra_plot::{Canvas, Color, Rect, Stroke};

/// Draws a white sheet behind a legend.
fn sheet(canvas: &mut Canvas, rect: Rect) {
    canvas.rectangle(rect, Color::WHITE.with_opacity(0.85));
    canvas.outline(&rect.corners(), &Stroke::new(Color::PALE, 0.8));
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_plot::{Pixels, Point};
    use spectra_spectrum::{AnySpectrum, find};

    fn pixel(pixels: &Pixels, at: Point) -> [i32; 3] {
        pixels.rgb[at[1] as usize * pixels.width_px as usize + at[0] as usize].map(i32::from)
    }

    fn found(name: &str) -> (String, AnySpectrum) {
        (name.to_owned(), find(name).expect("known"))
    }

    /// Frame of the figure: from x 92 to 876 for 350 to 830 nm, lower edge at y 434.
    #[test]
    fn wavelengths_have_their_colors_under_the_curve() {
        let pixels = spectrum(&[found("E")]).to_pixels(1.0);
        let under = |nm: f64| pixel(&pixels, [92.0 + (nm - 350.0) / 480.0 * 784.0, 400.0]);
        let ([r, g, b], [r1, g1, b1], [r2, g2, b2]) = (under(640.0), under(532.0), under(455.0));
        assert!(r > 200 && g < 90 && b < 90, "{r} {g} {b}");
        assert!(g1 > 200 && r1 < 160 && b1 < 120, "{r1} {g1} {b1}");
        assert!(b2 > 200 && r2 < 150 && g2 < 120, "{r2} {g2} {b2}");
        // A dark line is drawn at its wavelength, and there is nothing next to it.
        let pixels = spectrum(&[found("line:632.8")]).to_pixels(1.0);
        let at = |nm: f64| pixel(&pixels, [92.0 + (nm - 350.0) / 480.0 * 784.0, 395.0]);
        assert!(at(632.8)[1] < 120 && at(632.8)[0] > 150, "{:?}", at(632.8));
        assert!(at(637.0).iter().all(|v| *v > 200), "{:?}", at(637.0));
    }

    /// Scale of the figure: 800 canvas units per unit of x or y; x -0.08 is at 76, y 0.9 at 22.
    #[test]
    fn chromaticities_have_their_colors() {
        let pixels = chromaticity(&[]).to_pixels(1.0);
        let at = |x: f64, y: f64| pixel(&pixels, [76.0 + 800.0 * (x + 0.08), 22.0 + 800.0 * (0.9 - y)]);
        let ([r, g, b], [r1, g1, b1], [r2, g2, b2]) = (at(0.66, 0.32), at(0.20, 0.70), at(0.155, 0.035));
        assert!(r > 240 && g < 120 && b < 120, "{r} {g} {b}");
        assert!(g1 > 240 && r1 < 120 && b1 < 160, "{r1} {g1} {b1}");
        assert!(b2 > 240 && r2 < 160 && g2 < 140, "{r2} {g2} {b2}");
        // Just on the warm side of sRGB's white: 255, 244, 228 by its matrix and curve.
        let near = |(a, b): (i32, i32)| (a - b).abs() <= 4;
        assert!(at(0.33, 0.345).into_iter().zip([255, 244, 228]).all(near), "{:?}", at(0.33, 0.345));
        // Outside the locus there is nothing, and points lie where they belong.
        assert_eq!(at(0.53, 0.555), [255; 3]);
        let pixels = chromaticity(&[("here".to_owned(), [0.53, 0.555])]).to_pixels(1.0);
        assert!(pixel(&pixels, [76.0 + 800.0 * 0.61, 22.0 + 800.0 * 0.345])[0] < 128);
    }
}
