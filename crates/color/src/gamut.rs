//! Gamut mapping: brings a color that a screen cannot show into its gamut.

use crate::adaptation::Adaptation;
use crate::matrix::{Matrix, apply, inverse};
use crate::rgb::RgbSpace;

/// Methods of bringing linear RGB into the range 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Gamut {
    /// Clips each channel separately. It is fast, but changes hue and lightness.
    #[default]
    Clip,
    /// Moves the color toward the gray of the same luminance until it fits. Luminance stays the same; hue shifts as in mixing
    /// with white.
    Desaturate,
    /// Moves the color toward the gray of the same lightness, at constant lightness and hue in Oklab. The perceived hue stays the
    /// same.
    ///
    /// B. Ottosson, "A perceptual color space for image processing" (2020).
    Perceptual,
    /// Adds white at the same luminance until the most negative channel is 0, then darkens colors with a channel above 1. Colors
    /// that all lie outside the gamut, such as the colors of a spectrum, remain distinct.
    Compress,
}

/// Matrices from XYZ under D65 to cone-like responses, and from their cube roots to Oklab (Ottosson 2020).
const RESPONSES: Matrix = [
    [0.818_933_010_1, 0.361_866_742_4, -0.128_859_713_7],
    [0.032_984_543_6, 0.929_311_871_5, 0.036_145_638_7],
    [0.048_200_301_8, 0.264_366_269_1, 0.633_851_707_0],
];
const OKLAB: Matrix = [
    [0.210_454_255_3, 0.793_617_785_0, -0.004_072_046_8],
    [1.977_998_495_1, -2.428_592_205_0, 0.450_593_709_9],
    [0.025_904_037_1, 0.782_771_766_2, -0.808_675_766_0],
];

/// Converts `xyz` under D65, where white has Y = 1, to Oklab.
#[must_use]
pub fn oklab(xyz: [f64; 3]) -> [f64; 3] {
    apply(&OKLAB, apply(&RESPONSES, xyz).map(libm::cbrt))
}

/// Converts Oklab to XYZ under D65, where white has Y = 1.
#[must_use]
pub fn xyz_of_oklab(lab: [f64; 3]) -> [f64; 3] {
    apply(&inverse(&RESPONSES), apply(&inverse(&OKLAB), lab).map(|v| v * v * v))
}

fn fits(rgb: [f64; 3]) -> bool {
    // The tolerance covers the rounding of a matrix and its inverse.
    rgb.iter().all(|v| (-1e-12..=1.0 + 1e-12).contains(v))
}

fn clip(rgb: [f64; 3]) -> [f64; 3] {
    rgb.map(|v| if v.is_nan() { 0.0 } else { v.clamp(0.0, 1.0) })
}

/// Brings linear RGB of `space` into the range 0 to 1 by `method`. Colors in this range do not change. A color with a value that
/// is not finite is clipped, and NaN becomes 0.
#[must_use]
pub fn into_gamut(rgb: [f64; 3], space: &RgbSpace, method: Gamut) -> [f64; 3] {
    if fits(rgb) || method == Gamut::Clip || rgb.iter().any(|v| !v.is_finite()) {
        return clip(rgb);
    }
    match method {
        Gamut::Clip => clip(rgb),
        Gamut::Desaturate => desaturate(rgb, space),
        Gamut::Perceptual => perceptual(rgb, space),
        Gamut::Compress => compress(rgb, space),
    }
}

fn desaturate(rgb: [f64; 3], space: &RgbSpace) -> [f64; 3] {
    let grey = space.luminance(rgb).clamp(0.0, 1.0);
    // Largest fraction of the color that keeps every channel within 0 to 1.
    let share = rgb.iter().fold(1.0_f64, |share, v| match v - grey {
        d if d > 0.0 => share.min((1.0 - grey) / d),
        d if d < 0.0 => share.min(-grey / d),
        _ => share,
    });
    clip(rgb.map(|v| grey + share * (v - grey)))
}

fn compress(rgb: [f64; 3], space: &RgbSpace) -> [f64; 3] {
    let lacks = rgb.iter().fold(0.0_f64, |lacks, v| lacks.max(-v));
    let luminance = space.luminance(rgb);
    if luminance <= 0.0 {
        return [0.0; 3];
    }
    // White of value `lacks` has the luminance `lacks`.
    let mixed = rgb.map(|v| (v + lacks) * luminance / (luminance + lacks));
    let largest = mixed.iter().fold(1.0_f64, |a, b| a.max(*b));
    clip(mixed.map(|v| v / largest))
}

fn perceptual(rgb: [f64; 3], space: &RgbSpace) -> [f64; 3] {
    let d65 = RgbSpace::srgb().white_xyz();
    let white = space.white_xyz();
    let lab = oklab(Adaptation::Bradford.adapt(space.to_xyz(rgb), white, d65));
    let lightness = lab[0].clamp(0.0, 1.0);
    let at = |share: f64| {
        let xyz = xyz_of_oklab([lightness, share * lab[1], share * lab[2]]);
        space.from_xyz(Adaptation::Bradford.adapt(xyz, d65, white))
    };
    let (mut low, mut high) = (0.0, 1.0);
    // 40 halvings give the chroma within 1e-12 of the gamut surface.
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if fits(at(middle)) { low = middle } else { high = middle }
    }
    clip(at(low))
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_spectrum::Observer;

    const METHODS: [Gamut; 4] = [Gamut::Clip, Gamut::Desaturate, Gamut::Perceptual, Gamut::Compress];

    /// Compares four XYZ with the Oklab values that Ottosson (2020) prints to three decimals.
    #[test]
    fn oklab_of_published_colors() {
        for (xyz, want) in [
            ([0.950, 1.000, 1.089], [1.000, 0.000, 0.000]),
            ([1.000, 0.000, 0.000], [0.450, 1.236, -0.019]),
            ([0.000, 1.000, 0.000], [0.922, -0.671, 0.263]),
            ([0.000, 0.000, 1.000], [0.153, -1.415, -0.449]),
        ] {
            let got = oklab(xyz);
            assert!(got.iter().zip(want).all(|(a, b)| (a - b).abs() < 6e-4), "{got:?} {want:?}");
            assert!(xyz_of_oklab(got).iter().zip(xyz).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }

    #[test]
    fn colors_within_stay_and_others_come_within() {
        for space in RgbSpace::all() {
            for m in METHODS {
                assert_eq!(into_gamut([0.2, 0.0, 1.0], space, m), [0.2, 0.0, 1.0]);
                for nm in (380..=720).step_by(5) {
                    let rgb = space.from_xyz(Observer::cie_1931_2deg().at(f64::from(nm)));
                    let got = into_gamut(rgb, space, m);
                    assert!(got.iter().all(|v| (0.0..=1.0).contains(v)), "{nm} {m:?} {got:?}");
                }
                for rgb in [[-1.0; 3], [5.0; 3], [f64::NAN, 0.0, 2.0], [f64::INFINITY, 0.0, 0.0]] {
                    let got = into_gamut(rgb, space, m);
                    assert!(got.iter().all(|v| (0.0..=1.0).contains(v)), "{rgb:?} {m:?} {got:?}");
                }
            }
        }
    }

    /// A spectrum whose largest channel is 0.5 keeps all colors that are 10 nm apart distinct; clipping shows stretches of pure primaries.
    #[test]
    fn a_compressed_spectrum_has_all_its_colors() {
        let space = RgbSpace::srgb();
        let spectral = |nm: i32| {
            let rgb = space.from_xyz(Observer::cie_1931_2deg().at(f64::from(nm)));
            let largest = rgb.iter().fold(0.0_f64, |a, b| a.max(*b));
            rgb.map(|v| 0.5 * v / largest)
        };
        let shown = |nm: i32, method| into_gamut(spectral(nm), space, method);
        let least = |method| {
            let step = |nm: i32| {
                let (a, b) = (shown(nm, method), shown(nm + 10, method));
                a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            (440..620).step_by(10).map(step).fold(f64::INFINITY, f64::min)
        };
        let [clip, compress] = [Gamut::Clip, Gamut::Compress].map(least);
        assert!(compress > 0.005 && clip < 1e-12, "{clip} {compress}");
        for nm in (440..=640).step_by(5) {
            let [got, want] = [shown(nm, Gamut::Compress), spectral(nm)].map(|rgb| space.luminance(rgb));
            assert!(got < want + 1e-9, "{nm}: {got} {want}");
        }
    }

    #[test]
    fn desaturation_keeps_luminance_and_reaches_the_surface() {
        let space = RgbSpace::srgb();
        for rgb in [[0.9, 0.5, -0.2], [1.3, 0.2, 0.1], [-0.3, 0.4, 0.5]] {
            let got = into_gamut(rgb, space, Gamut::Desaturate);
            assert!((space.luminance(got) - space.luminance(rgb)).abs() < 1e-14, "{got:?}");
            assert!(got.iter().any(|v| *v < 1e-14 || *v > 1.0 - 1e-14), "{got:?}");
        }
    }

    #[test]
    fn the_perceptual_way_keeps_lightness_and_hue() {
        let space = RgbSpace::srgb();
        for rgb in [[0.9, 0.5, -0.2], [-0.3, 0.4, 0.5], [0.1, -0.05, 0.9]] {
            let before = oklab(space.to_xyz(rgb));
            let after = oklab(space.to_xyz(into_gamut(rgb, space, Gamut::Perceptual)));
            assert!((before[0] - after[0]).abs() < 1e-9);
            let hue = |l: [f64; 3]| libm::atan2(l[2], l[1]);
            assert!((hue(before) - hue(after)).abs() < 1e-6, "{before:?} {after:?}");
        }
    }
}
