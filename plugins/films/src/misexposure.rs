//! Detection of frames whose exposure lies outside the film's range: they would come out all black or all white.

use spectra_core::stage::Misexposure;

/// A curve counts as flat where it is nearer to one of its end values than this fraction of its whole range.
const FLAT: f64 = 0.01;
/// Range of log10 exposure (exposure in lx s) that covers all films, and the step at which curves are sampled.
const SPAN: [f64; 2] = [-8.0, 8.0];
const STEP: f64 = 0.02;
/// Fractions of the frame that must be out of range: too dark, or too bright. A few lights in the dark still make a picture, and so do
/// shadows in a bright frame.
const DARK: f64 = 0.999;
const BRIGHT: f64 = 0.99;
/// If a smaller fraction of the frame than this has any light, the light is a lamp in the dark.
const LAMP: f64 = 0.1;

/// Returns the log10 exposures (lx s) between which `curve`, a function of log10 exposure, is not flat.
pub(crate) fn ends(curve: impl Fn(f64) -> f64) -> [f64; 2] {
    let [least, most] = SPAN.map(&curve);
    let flat = FLAT * (most - least).abs();
    let at = |i: usize| SPAN[0] + i as f64 * STEP;
    let count = ((SPAN[1] - SPAN[0]) / STEP) as usize;
    let low = (0..count).find(|i| (curve(at(*i)) - least).abs() > flat).map_or(SPAN[0], at);
    let high = (0..count).rev().find(|i| (curve(at(*i)) - most).abs() > flat).map_or(SPAN[1], at);
    [low, high]
}

/// Returns whether nearly all of a frame is too dark or too bright for the film; `None` otherwise. Each layer is given as its plane, which
/// is in lx s once multiplied by `factor`, and the [`ends`] of its curve.
pub(crate) fn misexposure(layers: &[(&[f32], [f64; 2])], factor: f64) -> Option<Misexposure> {
    let pixels = layers.first()?.0.len();
    let ends: Vec<[f64; 2]> =
        layers.iter().map(|(_, ends)| ends.map(|x| spectra_core::math::pow(10.0, x) / factor)).collect();
    let each = |pixel: usize| layers.iter().zip(&ends).map(move |((plane, _), ends)| (f64::from(plane[pixel]), ends));
    let share = |is: &dyn Fn(usize) -> bool, of: usize| (0..pixels).filter(|p| is(*p)).count() as f64 / of as f64;
    let mean = |plane: &[f32]| plane.iter().map(|v| f64::from(*v)).sum::<f64>() / pixels as f64;
    let means: Vec<f64> = layers.iter().map(|(plane, _)| mean(plane)).collect();
    // If there is no light at all, the scene itself is black.
    if means.iter().all(|mean| *mean == 0.0) {
        return None;
    }
    let is_dark = means.iter().zip(&ends).all(|(mean, ends)| *mean < ends[0])
        && share(&|pixel| each(pixel).all(|(value, ends)| value < ends[0]), pixels) > DARK;
    if is_dark {
        return Some(Misexposure::Dark);
    }
    // Outside the image circle of a fisheye there is no light at any exposure, so only lit pixels count.
    let lit = (0..pixels).filter(|pixel| each(*pixel).any(|(value, _)| value > 0.0)).count();
    let is_bright = share(&|pixel| each(pixel).all(|(value, ends)| value > ends[1]), lit) > BRIGHT;
    (is_bright && lit as f64 > LAMP * pixels as f64).then_some(Misexposure::Bright)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_ends_where_it_is_flat() {
        let [low, high] = ends(|x| (x + 2.0).clamp(0.0, 3.0));
        assert!((low + 1.97).abs() < 0.03 && (high - 0.97).abs() < 0.03, "{low} {high}");
        // A falling curve, as of a reversal film, has the same ends.
        assert_eq!(ends(|x| -(x + 2.0).clamp(0.0, 3.0)), [low, high]);
    }

    #[test]
    fn lights_in_the_dark_and_shadows_in_the_light_are_pictures() {
        let curve = [-2.0, 1.0];
        let of = |plane: &[f32]| misexposure(&[(plane, curve)], 1.0);
        assert_eq!(of(&[0.001; 1000]), Some(Misexposure::Dark));
        assert_eq!(of(&[0.0; 1000]), None);
        assert_eq!(of(&[100.0; 1000]), Some(Misexposure::Bright));
        let mixed = |most: f32, few: f32, count: usize| [vec![few; count], vec![most; 1000 - count]].concat();
        assert_eq!(of(&mixed(0.001, 1.0, 2)), None);
        assert_eq!(of(&mixed(100.0, 1.0, 20)), None);
        assert_eq!(of(&mixed(100.0, 0.0, 500)), Some(Misexposure::Bright));
        assert_eq!(of(&mixed(100.0, 0.0, 999)), None);
        assert_eq!(misexposure(&[(&[1.0; 10], curve)], 1e-4), Some(Misexposure::Dark));
        assert_eq!(misexposure(&[(&[1.0; 10], curve)], 1e4), Some(Misexposure::Bright));
    }
}
