//! From absolute XYZ to a picture for a screen.
//!
//! The screen's white is D65, as sRGB has it, and nothing is adapted: a scene in tungsten light looks as
//! yellow as it is. What the screen cannot show moves straight toward the gray of its own luminance
//! ([`Gamut::Desaturate`]): a color outside of the gamut keeps luminance and hue and loses saturation, one
//! brighter than the screen can show it pales until, at the luminance of white, it is white. Neither hue nor
//! brightness breaks on the way.

use crate::lookup::PIXELS_A_TASK;
use rayon::prelude::*;
use spectra_color::matrix::{Matrix, apply};
use spectra_color::{Gamut, RgbSpace, into_gamut};
use spectra_core::frame::{Beside, DisplayPicture, ExposureChannel, ExposureFrame, Finished, FrameSize, Wanted};

/// Finds the exposure that is shown as white, from the frame alone: the same frame, the same answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AutoExposure {
    /// Share of the lit pixels (Y above 0) that are no brighter than the anchor, in (0, 1].
    pub quantile: f64,
    /// What the anchor is shown as, in linear light, in (0, 1].
    pub shown_as: f64,
}

impl Default for AutoExposure {
    /// The 99th percentile is shown as 0.9: a few highlights may clip, a lamp in the picture does not
    /// darken all else.
    fn default() -> Self {
        Self { quantile: 0.99, shown_as: 0.9 }
    }
}

impl AutoExposure {
    /// The Y that is to be shown as 1, in the unit of `y`; `None` where nothing is lit.
    ///
    /// Pixels without light do not count, else a small bright subject on black would have no
    /// brightness at all.
    #[must_use]
    pub fn white(&self, y: &[f32]) -> Option<f64> {
        let mut lit: Vec<f32> = y.iter().copied().filter(|v| *v > 0.0 && v.is_finite()).collect();
        if lit.is_empty() {
            return None;
        }
        // Nearest rank: the smallest value that this share of all does not exceed.
        let rank = ((self.quantile * lit.len() as f64).ceil() as usize).clamp(1, lit.len());
        let (_, anchor, _) = lit.select_nth_unstable_by(rank - 1, f32::total_cmp);
        Some(f64::from(*anchor) / self.shown_as)
    }
}

/// Which exposure is shown as white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum White {
    /// As the frame suggests.
    Auto(AutoExposure),
    /// This Y, in the unit of the frame: pictures of different scenes can be compared.
    Stated(f64),
}

impl Default for White {
    fn default() -> Self {
        Self::Auto(AutoExposure::default())
    }
}

/// A frame that cannot be shown.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the frame has no channel `{0}`")]
pub struct MissingChannel(pub String);

/// The channel of `frame` called `name`.
///
/// # Errors
/// [`MissingChannel`].
pub fn channel<'a>(frame: &'a ExposureFrame, name: &str) -> Result<&'a ExposureChannel, MissingChannel> {
    frame.channel(name).ok_or_else(|| MissingChannel(name.into()))
}

/// The picture of a frame with the channels `X`, `Y` and `Z` (CIE 1931).
///
/// # Errors
/// [`MissingChannel`].
pub fn show_xyz(frame: &ExposureFrame, white: White, gamut: Gamut) -> Result<DisplayPicture, MissingChannel> {
    finish_xyz(frame, white, gamut, None, Wanted::default()).map(|finished| finished.shown)
}

/// The same with what else is `wanted`; `adapted` brings XYZ under the light of the scene to D65 beforehand, and leaves Y of a
/// gray as it is.
///
/// # Errors
/// [`MissingChannel`].
pub fn finish_xyz(
    frame: &ExposureFrame,
    white: White,
    gamut: Gamut,
    adapted: Option<&Matrix>,
    wanted: Wanted,
) -> Result<Finished, MissingChannel> {
    let [x, y, z] = [channel(frame, "X")?, channel(frame, "Y")?, channel(frame, "Z")?];
    let white = match white {
        White::Auto(auto) => auto.white(&y.values),
        White::Stated(white) => Some(white),
    };
    // A frame without light is black whatever white is.
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
    let open = wanted.open.then(|| picture(&|rgb| rgb));
    let unit = &y.unit;
    let white = white.map(|white| if unit.is_empty() { format!("{white}") } else { format!("{white} {unit}") });
    Ok(Finished { shown, beside: Beside { open, layers: Vec::new(), white } })
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
        // One lamp a million times brighter moves it by one rank at most.
        let mut lamp = y.clone();
        lamp[500] = 1e9;
        assert!((AutoExposure::default().white(&lamp).expect("lit") / white - 1.0).abs() < 2e-3);
        // Black around it does not count, nor what is no number.
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

    /// Every spectral color at every exposure: in gamut, of its own luminance, and its place between gray and
    /// the true color never flips (the three differences from gray keep sign and order).
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
                // No break: a step of 0.005 in exposure moves no value by more than the steepest blue.
                if let Some(before) = before {
                    assert!((0..3).all(|i| (shown[i] - before[i]).abs() < 0.1), "{nm} {y}: {before:?} {shown:?}");
                }
                before = Some(shown);
            }
        }
    }
}
