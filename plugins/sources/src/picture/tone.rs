//! The tone curve of a camera, taken back: from a finished photograph to the light that it was taken in.
//!
//! What a camera writes is a picture to look at: steeper than the scene in the middle, with a shoulder that brings highlights under white.
//! Printed on film as it is it would get two such curves. With x the light of the scene and f that of the file, channel by channel as
//! cameras and films have them, the camera's curve is taken for
//!
//!   f = (1 + c) p / (p + c), p = (x / w)^g,
//!
//! a power in the shadows under a shoulder. Gray of 18 % stays where it is, and the file's white is w, 7.8 times that, 2.96 stops above
//! it: of a camera's saturation-based speed S, 78/S lx s saturates where 10/S lx s is metered (ISO 12232:2019). Assumed is c = 0.25, by
//! which the file is 1.32 times as steep as the scene at gray.

use spectra_core::math::{log, pow};

/// Light of mid gray in the file and in the scene.
pub(super) const MID_GRAY: f64 = 0.18;
/// White of the file over mid gray in the light of the scene.
const WHITE_OVER_GRAY: f64 = 7.8;
/// Sharpness of the shoulder.
const SHOULDER: f64 = 0.25;
/// Steps of the table, even in the root of the file's light.
const STEPS: usize = 1 << 13;

/// Light of the scene where the file has `file`, 0 or more: beyond the file's white in proportion.
fn scene(file: f64) -> f64 {
    let gray = SHOULDER * MID_GRAY / (1.0 + SHOULDER - MID_GRAY);
    let exponent = -log(WHITE_OVER_GRAY) / log(gray);
    let file_over_white = (SHOULDER * file.min(1.0) / (1.0 + SHOULDER - file.min(1.0))).max(0.0);
    WHITE_OVER_GRAY * MID_GRAY * pow(file_over_white, exponent) * file.max(1.0)
}

/// Light of the scene for that of a file.
pub(super) struct CameraTone(Vec<f32>);

impl CameraTone {
    pub(super) fn new() -> Self {
        let at = |i: usize| {
            let root = i as f64 / STEPS as f64;
            scene(root * root) as f32
        };
        Self((0..=STEPS).map(at).collect())
    }

    /// The curve taken back of one value, 0 or more.
    pub(super) fn value(&self, file: f32) -> f32 {
        let place = file.min(1.0).sqrt() * STEPS as f32;
        let at = (place as usize).min(STEPS - 1);
        let (a, b) = (self.0[at], self.0[at + 1]);
        (a + (b - a) * (place - at as f32)) * file.max(1.0)
    }

    /// The same of each channel of each pixel; values below 0, of colors beyond sRGB, stay in proportion to the largest.
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

    /// Gray stays, white lies 2.96 stops above it, and between them the curve is that of the formula above, turned around.
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
        // As steep as said.
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
