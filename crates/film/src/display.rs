//! Converts absolute XYZ to a picture for a screen.
//!
//! The screen's white is D65, as in sRGB, and nothing is adapted: a scene in tungsten light looks as yellow as it is.
//! Colors that the screen cannot show move straight toward the gray of their own luminance ([`Gamut::Desaturate`]). A color outside the
//! gamut keeps luminance and hue and loses saturation.
//! A color brighter than the screen can show becomes paler until, at the luminance of white, it is white. Hue and brightness change without
//! a break.

use crate::lookup::PIXELS_A_TASK;
use rayon::prelude::*;
use spectra_color::matrix::{Matrix, apply};
use spectra_color::{Gamut, RgbSpace, into_gamut};
use spectra_core::frame::{
    DisplayPicture, ExposureChannel, ExposureFrame, ExtraData, ExtraRequest, FinishedPicture, FrameSize,
};

/// Rule that finds the exposure shown as white, from the frame alone. The same frame always gives the same exposure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AutoExposure {
    /// Quantile in (0, 1] that defines the anchor: the fraction of the lit pixels (Y above 0) that are no brighter than the
    /// anchor.
    pub quantile: f64,
    /// Linear light as which the anchor is shown, in (0, 1].
    pub shown_as: f64,
}

impl Default for AutoExposure {
    /// Shows the 99th percentile as 0.9: a few highlights may clip, and a lamp in the picture does not darken everything else.
    fn default() -> Self {
        Self { quantile: 0.99, shown_as: 0.9 }
    }
}

impl AutoExposure {
    /// Returns the Y that is to be shown as 1, in the unit of `y`; `None` if no pixel is lit.
    ///
    /// Pixels without light do not count; otherwise a small bright subject on black would have no brightness at all.
    #[must_use]
    pub fn white(&self, y: &[f32]) -> Option<f64> {
        let mut lit: Vec<f32> = y.iter().copied().filter(|v| *v > 0.0 && v.is_finite()).collect();
        if lit.is_empty() {
            return None;
        }
        // Nearest rank: the smallest value that this fraction of all values does not exceed.
        let rank = ((self.quantile * lit.len() as f64).ceil() as usize).clamp(1, lit.len());
        let (_, anchor, _) = lit.select_nth_unstable_by(rank - 1, f32::total_cmp);
        Some(f64::from(*anchor) / self.shown_as)
    }
}

/// The exposure that is shown as white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum White {
    /// White is found from the frame.
    Auto(AutoExposure),
    /// White is this Y, in the unit of the frame, so that pictures of different scenes can be compared.
    Stated(f64),
}

impl Default for White {
    fn default() -> Self {
        Self::Auto(AutoExposure::default())
    }
}

/// Error for a frame that lacks a channel.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the frame has no channel `{0}`")]
pub struct MissingChannel(pub String);

/// Returns the channel of `frame` with the name `name`.
///
/// # Errors
/// [`MissingChannel`].
pub fn channel<'a>(frame: &'a ExposureFrame, name: &str) -> Result<&'a ExposureChannel, MissingChannel> {
    frame.channel(name).ok_or_else(|| MissingChannel(name.into()))
}

/// Converts a frame with the channels `X`, `Y` and `Z` (CIE 1931) to a picture for a screen. `white` is the exposure shown as
/// white, and `gamut` treats colors that the screen cannot show.
///
/// # Errors
/// [`MissingChannel`].
pub fn show_xyz(frame: &ExposureFrame, white: White, gamut: Gamut) -> Result<DisplayPicture, MissingChannel> {
    finish_xyz(frame, white, gamut, None, ExtraRequest::default()).map(|finished| finished.display)
}

/// Converts a frame as [`show_xyz`] does, and adds the results that `wanted` asks for. `adapted` is a matrix that first converts
/// XYZ under the light of the scene to XYZ under D65; it must keep Y of a gray. `None` adapts nothing.
///
/// # Errors
/// [`MissingChannel`].
pub fn finish_xyz(
    frame: &ExposureFrame,
    white: White,
    gamut: Gamut,
    adapted: Option<&Matrix>,
    wanted: ExtraRequest,
) -> Result<FinishedPicture, MissingChannel> {
    let [x, y, z] = [channel(frame, "X")?, channel(frame, "Y")?, channel(frame, "Z")?];
    let white = match white {
        White::Auto(auto) => auto.white(&y.values),
        White::Stated(white) => Some(white),
    };
    // A frame without light is black, whatever white is.
    let scale = white.map_or(0.0, |white| 1.0 / white);
    let srgb = RgbSpace::srgb();
    let linear = |((x, y), z): ((&f32, &f32), &f32)| {
        let xyz = [x, y, z].map(|v| f64::from(*v) * scale);
        srgb.from_xyz(adapted.map_or(xyz, |matrix| apply(matrix, xyz)))
    };
    let FrameSize { width_px, height_px, .. } = frame.size;
    let picture = |of: &(dyn Fn([f64; 3]) -> [f64; 3] + Sync)| {
        let pixels = x.values.par_iter().zip(&y.values).zip(&z.values).with_min_len(PIXELS_A_TASK);
        let rgb = pixels.map(|pixel| of(linear(pixel)).map(|v| v as f32)).collect();
        DisplayPicture { width_px, height_px, rgb }
    };
    let shown = picture(&|rgb| into_gamut(rgb, srgb, gamut));
    let open = wanted.unclamped.then(|| picture(&|rgb| rgb));
    let unit = &y.unit;
    let white = white.map(|white| if unit.is_empty() { format!("{white}") } else { format!("{white} {unit}") });
    Ok(FinishedPicture { display: shown, extra: ExtraData { unclamped: open, layers: Vec::new(), white } })
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_spectrum::Observer;

    fn frame(pixels: &[[f64; 3]]) -> ExposureFrame {
        let size = FrameSize { width_px: pixels.len() as u32, height_px: 1, width_mm: 1.0, height_mm: 1.0 };
        let channel = |i: usize, name: &str| ExposureChannel {
            name: name.into(),
            unit: "lx s".into(),
            values: pixels.iter().map(|p| p[i] as f32).collect(),
        };
        ExposureFrame { size, channels: vec![channel(0, "X"), channel(1, "Y"), channel(2, "Z")] }
    }

    #[test]
    fn stated_white_is_one_and_half_of_it_a_half() {
        let white = RgbSpace::srgb().white_xyz();
        let shown = show_xyz(
            &frame(&[white.map(|v| v * 40.0), white.map(|v| v * 20.0), [0.0; 3]]),
            White::Stated(40.0),
            Gamut::Desaturate,
        );
        let rgb = shown.expect("complete").rgb;
        for (got, want) in rgb.iter().zip([1.0, 0.5, 0.0]) {
            assert!(got.iter().all(|v| (v - want).abs() < 1e-6), "{rgb:?}");
        }
    }

    #[test]
    fn the_primaries_of_the_screen_are_shown_as_themselves() {
        for i in 0..3 {
            let mut wanted = [0.0; 3];
            wanted[i] = 0.7;
            let shown = show_xyz(&frame(&[RgbSpace::srgb().to_xyz(wanted)]), White::Stated(1.0), Gamut::Desaturate)
                .expect("complete");
            assert!((0..3).all(|j| (f64::from(shown.rgb[0][j]) - wanted[j]).abs() < 1e-6), "{:?}", shown.rgb[0]);
        }
    }

    #[test]
    fn automatic_exposure_puts_the_percentile_at_its_place() {
        // 1 to 1000: the 99th percentile is 990 by nearest rank.
        let y: Vec<f32> = (1..=1000).rev().map(|i| i as f32).collect();
        let white = AutoExposure::default().white(&y).expect("lit");
        assert!((990.0 / white - 0.9).abs() < 1e-12);
        // A single lamp a million times brighter moves it by one rank at most.
        let mut lamp = y.clone();
        lamp[500] = 1e9;
        assert!((AutoExposure::default().white(&lamp).expect("lit") / white - 1.0).abs() < 2e-3);
        // Black surroundings and NaN do not count.
        let mut framed = y;
        framed.extend([0.0; 5000]);
        framed.push(f32::NAN);
        assert_eq!(AutoExposure::default().white(&framed), Some(white));
        assert_eq!(AutoExposure::default().white(&[0.0; 9]), None);
    }

    #[test]
    fn a_frame_without_light_is_black() {
        let shown = show_xyz(&frame(&[[0.0; 3]; 4]), White::default(), Gamut::Desaturate).expect("complete");
        assert!(shown.rgb.iter().all(|p| *p == [0.0; 3]));
        let mut incomplete = frame(&[[1.0; 3]]);
        incomplete.channels.remove(2);
        assert_eq!(show_xyz(&incomplete, White::default(), Gamut::Desaturate), Err(MissingChannel("Z".into())));
    }

    /// Every spectral color at every exposure stays in gamut, keeps its luminance, and lies between gray and the true color: its three
    /// differences from gray keep sign and order.
    #[test]
    fn colors_outside_of_the_gamut_keep_hue_and_luminance() {
        let srgb = RgbSpace::srgb();
        for nm in (400..700).step_by(10) {
            let xyz = Observer::cie_1931_2deg().at(f64::from(nm));
            let mut before: Option<[f64; 3]> = None;
            for step in 0..300 {
                let y = 0.005 * f64::from(step);
                let scaled = xyz.map(|v| v / xyz[1] * y);
                let raw = srgb.from_xyz(scaled);
                let shown = into_gamut(raw, srgb, Gamut::Desaturate);
                assert!(shown.iter().all(|v| (0.0..=1.0).contains(v)));
                assert!((srgb.luminance(shown) - y.min(1.0)).abs() < 1e-9, "{nm} {y}");
                for i in 0..3 {
                    assert!((shown[i] - y.min(1.0)) * (raw[i] - y) >= -1e-9, "{nm} {y}");
                }
                // There is no break: a step of 0.005 in exposure changes no value by more than the steepest blue.
                if let Some(before) = before {
                    assert!((0..3).all(|i| (shown[i] - before[i]).abs() < 0.1), "{nm} {y}: {before:?} {shown:?}");
                }
                before = Some(shown);
            }
        }
    }
}
