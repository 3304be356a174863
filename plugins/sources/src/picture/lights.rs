//! Finds the lights of a picture: few pixels that are much brighter than the rest.
//!
//! Rays from the imager hit small bright objects by chance, which is noisy where these are out of focus. Rays from the bright
//! pixels always reach the imager. The picture is therefore split into a sum of two: its light times `share`, and its light times
//! one minus `share`. `share` is 1 on the pixels of lights, 0 on others, and linear between their centers like the light itself.
//!
//! A pixel is a light if it is brighter than [`TIMES`] times the mean of the pixels that are not, and among the brightest
//! [`MOST`] of all. Its eight neighbors are lights, too, so that all light between a light and a neighbor belongs to the lights.
//! Both sums are the picture times a weight, so they work with any color model. Which pixels are lights is a rule of the picture alone.
//!
//! Two directions pay if a pixel of the frame that sees all of the picture would have at most an eighth of the variance ([`PAYS`]).
//!
//! **Limits.** A window of many pixels is not a light, however bright it is. Rays from the source would land at random and leave
//! 4 to 5 % of color noise in each pixel of the window. Rays from the imager leave noise only at its blurred edges. For a window
//! of a seventh of the picture, the noise only moved from its edges to its middle, and rendering took six times as long. Noise
//! remains because each ray has one wavelength: behind the last surface that disperses light (seen from the imager), each
//! wavelength takes a path of its own.

use super::light_sampler::LightSampler;
use spectra_core::spectral::SpectralPower;

/// Smallest ratio of the brightness of a light to the mean of the rest.
const TIMES: f64 = 8.0;
/// Largest fraction of a picture that can be lights.
const MOST: f64 = 0.05;
/// Smallest factor by which the variance of a fully blurred picture must fall to make tracing in two directions worthwhile: two
/// directions cost up to four times as much as one.
const PAYS: f64 = 8.0;
/// Fraction of the lights' mean brightness with which a black pixel of a light is drawn, since there may be light around its center.
const LEAST: f32 = 1e-3;

/// The lights of a picture.
pub(crate) struct Lights {
    /// Brightness of each pixel, above 0, if it is a light; 0 otherwise.
    pub level: Vec<f32>,
    /// Whether each pixel, or its neighbor to the right, below or to the lower right, is a light. If not, no light interpolated between
    /// these four belongs to the lights.
    pub touched: Vec<bool>,
    /// Draws points on the lights.
    pub places: LightSampler,
    /// Mean light over the picture, of the lights and of the rest.
    pub mean: [SpectralPower; 2],
    /// Ratio of peak to mean, of the lights and of the rest, each among its own pixels.
    pub peak_over_mean: [f64; 2],
    pub pays: bool,
}

/// The lights as found from the brightness of pixels, before their spectra are known.
pub(super) struct LightPixels {
    pub level: Vec<f32>,
    /// Brightness limit: a pixel that is not brighter is a light only as the neighbor of one.
    pub limit: f32,
    pub peak_over_mean: [f64; 2],
    pub pays: bool,
}

/// Computes [`Lights::touched`] from the level of each pixel.
pub(super) fn touched(width: usize, level: &[f32]) -> Vec<bool> {
    let height = level.len() / width;
    let lit = |row: usize, column: usize| level[row.min(height - 1) * width + column.min(width - 1)] > 0.0;
    let any = |(r, c)| lit(r, c) || lit(r, c + 1) || lit(r + 1, c) || lit(r + 1, c + 1);
    (0..level.len()).map(|i| any((i / width, i % width))).collect()
}

/// Finds the lights among pixels of this brightness; `None` if there are none.
pub(super) fn find(width: usize, brightness: &[f32]) -> Option<LightPixels> {
    let all = brightness.len() as f64;
    let mean = |limit: f64| {
        let dark = brightness.iter().map(|b| f64::from(b.max(0.0))).filter(|b| *b <= limit);
        let (sum, count) = dark.fold((0.0, 0_u64), |(sum, count), b| (sum + b, count + 1));
        if count > 0 { sum / count as f64 } else { 0.0 }
    };
    let peak = brightness.iter().fold(0.0_f32, |a, b| a.max(*b));
    if !peak.is_finite() {
        return None;
    }
    let mut limit = f64::from(peak);
    loop {
        let lower = TIMES * mean(limit);
        if lower >= limit {
            break;
        }
        limit = lower;
    }
    let place = ((1.0 - MOST) * all) as usize;
    let mut sorted = brightness.to_vec();
    let (_, quantile, _) = sorted.select_nth_unstable_by(place.min(brightness.len() - 1), f32::total_cmp);
    let limit = limit.max(f64::from(*quantile)) as f32;
    drop(sorted);
    let height = brightness.len() / width;
    let mut level = vec![0.0_f32; brightness.len()];
    let mut any = false;
    for (at, _) in brightness.iter().enumerate().filter(|(_, b)| **b > limit) {
        any = true;
        let (column, row) = (at % width, at / width);
        for r in row.saturating_sub(1)..=(row + 1).min(height - 1) {
            for c in column.saturating_sub(1)..=(column + 1).min(width - 1) {
                level[r * width + c] = 1.0;
            }
        }
    }
    if !any {
        return None;
    }
    // First and second moment, peak and number of pixels, for the lights and for the rest.
    let mut moments = [[0.0_f64; 4]; 2];
    for (b, level) in brightness.iter().zip(&level) {
        let b = f64::from(b.max(0.0));
        let [first, second, peak, count] = &mut moments[usize::from(*level == 0.0)];
        (*first, *second, *peak, *count) = (*first + b, *second + b * b, peak.max(b), *count + 1.0);
    }
    let [lights, rest] = moments;
    let of = |sum: f64| sum / all;
    let square = |x: f64| x * x;
    // Variances for a pixel of the imager that sees the whole picture. Backward, each sample finds one point of the picture; forward,
    // a ray from a light finds one of all pixels.
    let one = of(lights[1] + rest[1]) - square(of(lights[0] + rest[0]));
    let two = of(rest[1]) - square(of(rest[0])) + square(of(lights[0]));
    let least = LEAST * (lights[0] / lights[3]) as f32;
    level.iter_mut().zip(brightness).filter(|(level, _)| **level > 0.0).for_each(|(level, b)| *level = b.max(least));
    let peak_over_mean = moments.map(|[sum, _, peak, count]| if sum > 0.0 { peak * count / sum } else { 1.0 });
    Some(LightPixels { level, limit, peak_over_mean, pays: one >= PAYS * two })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(lamps: &[(usize, f32)]) -> Vec<f32> {
        let mut all: Vec<f32> = (0..1200).map(|i| 0.1 + 0.05 * (i % 7) as f32).collect();
        lamps.iter().for_each(|(at, b)| all[*at] = *b);
        all
    }

    #[test]
    fn lamps_are_found_with_their_neighbors() {
        let found = find(40, &picture(&[(10 * 40 + 20, 50.0)])).expect("a lamp");
        let lit: Vec<usize> = (0..1200).filter(|i| found.level[*i] > 0.0).collect();
        assert_eq!(lit, [379, 380, 381, 419, 420, 421, 459, 460, 461]);
        assert!(found.pays && found.level[420] == 50.0);
    }

    #[test]
    fn a_photograph_has_none_and_glints_do_not_pay() {
        assert!(find(40, &picture(&[])).is_none());
        assert!(find(40, &picture(&[(5, 1.0), (70, 0.9)])).is_none());
        let weak = find(40, &picture(&[(5, 2.5)])).expect("a glint");
        assert!(!weak.pays);
    }

    #[test]
    fn stars_on_black_are_lights_each() {
        let mut black = vec![0.0_f32; 1200];
        (black[100], black[700]) = (1.0, 0.5);
        let found = find(40, &black).expect("stars");
        assert!(found.pays && found.level[100] > 0.0 && found.level[700] > 0.0 && found.level[101] > 0.0);
        assert!(found.level[101] < 0.01);
    }

    #[test]
    fn what_is_not_few_is_no_light() {
        let half: Vec<f32> = (0..1200).map(|i| if i % 2 == 0 { 100.0 } else { 0.1 }).collect();
        assert!(find(40, &half).is_none());
    }
}
