//! Resamples pictures to square pixels.

use rayon::prelude::*;
use spectra_core::frame::DisplayPicture;

/// Resamples a picture whose pixels are `pixel_aspect` times as wide as high to square pixels. The picture grows along one side, so no
/// detail is lost.
///
/// Interpolates with the cubic of E. Catmull and R. Rom (1974) in linear light. Negative overshoot, next to lamps, is clipped to 0 if the
/// neighboring pixels are not negative.
#[must_use]
pub fn squared(picture: &DisplayPicture, pixel_aspect: f64) -> DisplayPicture {
    let (width, height) = (picture.width_px as usize, picture.height_px as usize);
    let grown = |side: usize, by: f64| ((side as f64 * by).round() as usize).max(1);
    if pixel_aspect >= 1.0 {
        let wide = grown(width, pixel_aspect);
        let taps = taps(width, wide);
        let rows = picture.rgb.par_chunks(width.max(1));
        let rgb = rows.flat_map_iter(|row| taps.iter().map(|tap| tap.of(|i| row[i]))).collect();
        return DisplayPicture { width_px: wide as u32, height_px: picture.height_px, rgb };
    }
    let high = grown(height, 1.0 / pixel_aspect);
    let taps = taps(height, high);
    let rgb = taps.par_iter().flat_map_iter(|tap| (0..width).map(|x| tap.of(|y| picture.rgb[y * width + x]))).collect();
    DisplayPicture { width_px: picture.width_px, height_px: high as u32, rgb }
}

/// Indices of four neighbors and their weights.
struct Tap {
    at: [usize; 4],
    weight: [f64; 4],
}

impl Tap {
    fn of(&self, pixel: impl Fn(usize) -> [f32; 3]) -> [f32; 3] {
        let pixels = self.at.map(pixel);
        [0, 1, 2].map(|c| {
            let values = pixels.map(|p| f64::from(p[c]));
            let sum = values.iter().zip(&self.weight).fold(0.0, |sum, (v, w)| sum + v * w);
            let floor = values.iter().copied().fold(f64::INFINITY, f64::min).min(0.0);
            sum.max(floor) as f32
        })
    }
}

/// Computes the neighbors and weights that resample `from` pixels to `to` pixels.
fn taps(from: usize, to: usize) -> Vec<Tap> {
    let one = |i: usize| {
        let place = (i as f64 + 0.5) * from as f64 / to as f64 - 0.5;
        let t = place - place.floor();
        let weight = [
            0.5 * t * (-1.0 + t * (2.0 - t)),
            1.0 + 0.5 * t * t * (-5.0 + 3.0 * t),
            0.5 * t * (1.0 + t * (4.0 - 3.0 * t)),
            0.5 * t * t * (-1.0 + t),
        ];
        let last = from as i64 - 1;
        let at = [-1, 0, 1, 2].map(|k| (place.floor() as i64 + k).clamp(0, last.max(0)) as usize);
        Tap { at, weight }
    };
    (0..to).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(width: u32, height: u32, value: impl Fn(f64, f64) -> f64) -> DisplayPicture {
        let pixel = |i: u32| [value(f64::from(i % width) + 0.5, f64::from(i / width) + 0.5) as f32; 3];
        DisplayPicture { width_px: width, height_px: height, rgb: (0..width * height).map(pixel).collect() }
    }

    /// A ramp stays a ramp along either side; a lamp stays above 0; square pixels do not change.
    #[test]
    fn straight_lines_stay_straight() {
        let wide = squared(&ramp(20, 3, |x, _| x / 20.0), 1.9);
        assert_eq!((wide.width_px, wide.height_px), (38, 3));
        for (i, pixel) in wide.rgb.iter().enumerate().filter(|(i, _)| (4..34).contains(&(i % 38))) {
            let want = ((i % 38) as f64 + 0.5) / 38.0;
            assert!((f64::from(pixel[0]) - want).abs() < 1e-6, "{i}: {pixel:?}");
        }
        let high = squared(&ramp(3, 20, |_, y| y / 20.0), 0.5);
        assert_eq!((high.width_px, high.height_px), (3, 40));
        assert!((f64::from(high.rgb[20 * 3][1]) - 20.5 / 40.0).abs() < 1e-6);
        let lamp = squared(&ramp(9, 1, |x, _| if x == 4.5 { 1.0 } else { 0.0 }), 1.9);
        assert!(lamp.rgb.iter().all(|p| p[0] >= 0.0) && lamp.rgb.iter().any(|p| p[0] > 0.9));
        let same = ramp(5, 4, |x, y| x * y);
        assert_eq!(squared(&same, 1.0), same);
    }
}
