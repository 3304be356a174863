//! Inverse of a camera's tone curve: from a finished photograph to the light of the scene.
//!
//! A camera writes a picture for viewing: steeper than the scene in the midtones, with a shoulder that keeps highlights below white.
//! Exposed on film unchanged, it would get two such curves. With x the light of the scene and f that of the file, separately for each
//! channel as in cameras and films, the camera's curve is assumed to be
//!
//!   f = (1 + c) p / (p + c), p = (x / w)^g,
//!
//! a power law in the shadows below a shoulder. Gray of 18 % does not change. The file's white is w, 7.8 times as bright, 2.96 stops above
//! gray, since at a saturation-based speed S a camera saturates at 78/S lx s and meters for 10/S lx s (ISO 12232:2019). The assumed
//! c = 0.25 makes the file 1.32 times as steep as the scene at gray.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::{log, pow};

/// `tone` as written in a scene.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Tone {
    /// The tone curve of a camera.
    Camera,
    /// No tone curve: values are proportional to light.
    #[default]
    None,
}

/// Mid gray in the file and in the scene, as a fraction of white.
pub(super) const MID_GRAY: f64 = 0.18;
/// Ratio of the file's white to mid gray, in the light of the scene.
const WHITE_OVER_GRAY: f64 = 7.8;
/// Sharpness of the shoulder.
const SHOULDER: f64 = 0.25;
/// Number of steps of the table, equal in the square root of the file's light.
const STEPS: usize = 1 << 13;

/// Returns the light of the scene for a value of the file, 0 or more. Beyond the file's white it is proportional.
fn scene(file: f64) -> f64 {
    let gray = SHOULDER * MID_GRAY / (1.0 + SHOULDER - MID_GRAY);
    let exponent = -log(WHITE_OVER_GRAY) / log(gray);
    let file_over_white = (SHOULDER * file.min(1.0) / (1.0 + SHOULDER - file.min(1.0))).max(0.0);
    WHITE_OVER_GRAY * MID_GRAY * pow(file_over_white, exponent) * file.max(1.0)
}

/// Table of the scene's light as a function of the file's.
pub(super) struct CameraTone(Vec<f32>);

impl CameraTone {
    pub(super) fn new() -> Self {
        let at = |i: usize| {
            let root = i as f64 / STEPS as f64;
            scene(root * root) as f32
        };
        Self((0..=STEPS).map(at).collect())
    }

    /// Undoes the curve for one value, 0 or more.
    pub(super) fn value(&self, file: f32) -> f32 {
        let place = file.min(1.0).sqrt() * STEPS as f32;
        let at = (place as usize).min(STEPS - 1);
        let (a, b) = (self.0[at], self.0[at + 1]);
        (a + (b - a) * (place - at as f32)) * file.max(1.0)
    }

    /// Undoes the curve in each channel of each pixel. Values below 0, of colors outside sRGB, are scaled like the largest one.
    pub(super) fn take_back(&self, rgb: &mut [[f32; 3]]) {
        for pixel in rgb {
            let largest = pixel.iter().copied().fold(0.0_f32, f32::max);
            let factor = if largest > 0.0 { self.value(largest) / largest } else { 1.0 };
            *pixel = pixel.map(|v| if v < 0.0 { v * factor } else { self.value(v) });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gray does not change, white lies 2.96 stops above it, and the values between follow the inverse of the formula above.
    #[test]
    fn gray_stays_and_white_is_where_sensors_saturate() {
        let tone = CameraTone::new();
        assert!((f64::from(tone.value(0.18)) - 0.18).abs() < 1e-6);
        assert!((f64::from(tone.value(1.0)) / 0.18 - 7.8).abs() < 1e-5);
        assert!((f64::from(tone.value(2.0)) / 0.18 - 15.6).abs() < 1e-5);
        assert_eq!(tone.value(0.0), 0.0);
        let exponent = (0.18_f64 * 0.25 / 1.07).ln() / -7.8_f64.ln();
        let mut before = 0.0;
        for i in 1..400 {
            let x = 0.18 * 7.8 * (f64::from(i) / 400.0).powi(3);
            let p = (x / (0.18 * 7.8)).powf(exponent);
            let found = f64::from(tone.value((1.25 * p / (p + 0.25)) as f32));
            assert!((found / x - 1.0).abs() < 2e-3 || (found - x).abs() < 1e-6, "{x}: {found}");
            assert!(found > before);
            before = found;
        }
        // The slope at gray is the documented one.
        let slope = (scene(0.1818) / scene(0.1782)).ln() / (0.1818_f64 / 0.1782).ln();
        assert!((slope - 1.0 / 1.32).abs() < 0.01, "{slope}");
    }

    #[test]
    fn each_channel_has_the_curve() {
        let tone = CameraTone::new();
        let mut pixels = [[0.5, 0.18, 0.02], [0.5, -0.1, 0.0], [0.0, -0.1, -0.2]];
        tone.take_back(&mut pixels);
        assert_eq!(pixels[0], [0.5, 0.18, 0.02].map(|v| tone.value(v)));
        assert!((pixels[1][1] / -0.1 - pixels[1][0] / 0.5).abs() < 1e-6);
        assert_eq!(pixels[2], [0.0, -0.1, -0.2]);
    }
}
