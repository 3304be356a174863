//! View of a picture in its own colors.

use super::measured::{Measured, NotMeasured};
use super::view::{Shown, sheet};
use spectra_color::{Gamut, RgbSpace, into_gamut, to_u8};
use spectra_plot::Canvas;

/// Draws the picture as a screen shows it, in sRGB. `white` is the Y of full white in the picture's unit; if `None`, [`Measured::white`] is
/// used. Colors outside sRGB are brought into it at constant hue.
///
/// # Errors
/// The picture has no colors, or no pixel of it is lit.
pub fn color(picture: &Measured, white: Option<f64>, title: &str) -> Result<Canvas, NotMeasured> {
    if picture.colors.is_none() {
        return Err(picture.without_colors());
    }
    let white = white.or_else(|| picture.white()).ok_or_else(super::quantity_map::dark)?;
    let srgb = RgbSpace::srgb();
    // Average linear light, which adds up: a reduced picture shows means.
    let [x, y, z] = [0, 1, 2].map(|i| {
        let shown = Shown::of(picture, false, &|pixel| picture.xyz_under_d65(pixel).map_or(f64::NAN, |xyz| xyz[i]));
        (shown.values, shown.frame, shown.columns, shown.rows)
    });
    let rgb = x.0.iter().zip(&y.0).zip(&z.0).map(|((x, y), z)| {
        let linear = srgb.from_xyz([*x, *y, *z].map(|v| if v.is_finite() { v / white } else { 0.0 }));
        srgb.encode(into_gamut(linear, srgb, Gamut::Perceptual)).map(to_u8)
    });
    let rgb: Vec<[u8; 3]> = rgb.collect();
    let note = super::quantity_map::describe_white(white, picture.unit);
    let shown = Shown { frame: x.1, columns: x.2, rows: x.3, values: Vec::new() };
    Ok(sheet(picture, title, Some(&note), &shown, rgb))
}
