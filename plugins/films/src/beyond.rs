//! Frames that are wholly beyond what a film can tell apart: black or white, whatever the picture is of.

use spectra_core::stage::Beyond;

/// Nearer than this share of its range to where it ends, a curve tells nothing apart.
const FLAT: f64 = 0.01;
/// Log10 of exposures, lx s, between which all films lie, and the step in which their curves are looked at.
const SPAN: [f64; 2] = [-8.0, 8.0];
const STEP: f64 = 0.02;
/// Lights in the dark make a picture; so do shadows in a bright one: shares of the frame that are beyond.
const DARK: f64 = 0.999;
const BRIGHT: f64 = 0.99;
/// A smaller part of the frame that has any light is a lamp in the dark.
const LAMP: f64 = 0.1;

/// Log10 of the exposures, lx s, between which `curve` (of log10 of the exposure) tells light apart.
pub(crate) fn ends(curve: impl Fn(f64) -> f64) -> [f64; 2] {
    let [least, most] = SPAN.map(&curve);
    let flat = FLAT * (most - least).abs();
    let at = |i: usize| SPAN[0] + i as f64 * STEP;
    let count = ((SPAN[1] - SPAN[0]) / STEP) as usize;
    let low = (0..count).find(|i| (curve(at(*i)) - least).abs() > flat).map_or(SPAN[0], at);
    let high = (0..count).rev().find(|i| (curve(at(*i)) - most).abs() > flat).map_or(SPAN[1], at);
    [low, high]
}

/// Whether a frame is: of each layer its plane, lx s once multiplied by `factor`, and the [`ends`] of its curve.
pub(crate) fn beyond(layers: &[(&[f32], [f64; 2])], factor: f64) -> Option<Beyond> {
    let pixels = layers.first()?.0.len();
    let ends: Vec<[f64; 2]> =
        layers.iter().map(|(_, ends)| ends.map(|x| spectra_core::math::pow(10.0, x) / factor)).collect();
    let each = |pixel: usize| layers.iter().zip(&ends).map(move |((plane, _), ends)| (f64::from(plane[pixel]), ends));
    let share = |is: &dyn Fn(usize) -> bool, of: usize| (0..pixels).filter(|p| is(*p)).count() as f64 / of as f64;
    let mean = |plane: &[f32]| plane.iter().map(|v| f64::from(*v)).sum::<f64>() / pixels as f64;
    let means: Vec<f64> = layers.iter().map(|(plane, _)| mean(plane)).collect();
    // Without any light it is the scene that is black.
    if means.iter().all(|mean| *mean == 0.0) {
        return None;
    }
    let is_dark = means.iter().zip(&ends).all(|(mean, ends)| *mean < ends[0])
        && share(&|pixel| each(pixel).all(|(value, ends)| value < ends[0]), pixels) > DARK;
    if is_dark {
        return Some(Beyond::Dark);
    }
    // Beside the circle of a fisheye there is no light at any exposure.
    let lit = (0..pixels).filter(|pixel| each(*pixel).any(|(value, _)| value > 0.0)).count();
    let is_bright = share(&|pixel| each(pixel).all(|(value, ends)| value > ends[1]), lit) > BRIGHT;
    (is_bright && lit as f64 > LAMP * pixels as f64).then_some(Beyond::Bright)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_ends_where_it_is_flat() {
        let [low, high] = ends(|x| (x + 2.0).clamp(0.0, 3.0));
        assert!((low + 1.97).abs() < 0.03 && (high - 0.97).abs() < 0.03, "{low} {high}");
        // Of a reversal film as well.
        assert_eq!(ends(|x| -(x + 2.0).clamp(0.0, 3.0)), [low, high]);
    }

    #[test]
    fn lights_in_the_dark_and_shadows_in_the_light_are_pictures() {
        let curve = [-2.0, 1.0];
        let of = |plane: &[f32]| beyond(&[(plane, curve)], 1.0);
        assert_eq!(of(&[0.001; 1000]), Some(Beyond::Dark));
        assert_eq!(of(&[0.0; 1000]), None);
        assert_eq!(of(&[100.0; 1000]), Some(Beyond::Bright));
        let mixed = |most: f32, few: f32, count: usize| [vec![few; count], vec![most; 1000 - count]].concat();
        assert_eq!(of(&mixed(0.001, 1.0, 2)), None);
        assert_eq!(of(&mixed(100.0, 1.0, 20)), None);
        assert_eq!(of(&mixed(100.0, 0.0, 500)), Some(Beyond::Bright));
        assert_eq!(of(&mixed(100.0, 0.0, 999)), None);
        assert_eq!(beyond(&[(&[1.0; 10], curve)], 1e-4), Some(Beyond::Dark));
        assert_eq!(beyond(&[(&[1.0; 10], curve)], 1e4), Some(Beyond::Bright));
    }
}
