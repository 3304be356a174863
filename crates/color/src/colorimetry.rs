//! Tristimulus values, chromaticity and CIE Lab of lights, surfaces and filters.

use spectra_core::spectral::{BAND, Line};
use spectra_spectrum::{Emission, Observer, Reflectance, Transmittance};

/// Returns the chromaticity x, y of `xyz`; `None` if X + Y + Z is not positive and finite.
#[must_use]
pub fn chromaticity(xyz: [f64; 3]) -> Option<[f64; 2]> {
    let sum = xyz[0] + xyz[1] + xyz[2];
    (sum > 0.0 && sum.is_finite()).then(|| [xyz[0] / sum, xyz[1] / sum])
}

/// Computes XYZ of a light, scaled to Y = 100; `None` if the observer sees none of it.
#[must_use]
pub fn xyz_of_light(light: &Emission, observer: &Observer) -> Option<[f64; 3]> {
    let xyz = observer.xyz(light);
    (xyz[1] > 0.0 && xyz[1].is_finite()).then(|| xyz.map(|v| 100.0 * v / xyz[1]))
}

/// Computes XYZ of a surface under `light`, where the perfect diffuser has Y = 100; `None` if the observer sees no light.
#[must_use]
pub fn xyz_of_reflectance(surface: &Reflectance, light: &Emission, observer: &Observer) -> Option<[f64; 3]> {
    xyz_of_matter(|w| surface.at(w), &surface.on_grid(&BAND), light, observer)
}

/// Computes XYZ of `light` seen through a filter, where `light` alone has Y = 100; `None` if the observer sees no light.
#[must_use]
pub fn xyz_of_transmittance(filter: &Transmittance, light: &Emission, observer: &Observer) -> Option<[f64; 3]> {
    xyz_of_matter(|w| filter.at(w), &filter.on_grid(&BAND), light, observer)
}

fn xyz_of_matter(at: impl Fn(f64) -> f64, on_band: &[f64], light: &Emission, observer: &Observer) -> Option<[f64; 3]> {
    let white = light.to_power(&BAND);
    let mut seen = white.clone();
    seen.continuum.iter_mut().zip(on_band).for_each(|(p, f)| *p *= f);
    seen.lines = white.lines.iter().map(|l| Line { power: l.power * at(l.wavelength_nm), ..*l }).collect();
    let full = observer.xyz_of_power(&white)[1];
    (full > 0.0 && full.is_finite()).then(|| observer.xyz_of_power(&seen).map(|v| 100.0 * v / full))
}

/// Converts `xyz` to CIE 1976 L*, a*, b* relative to `white`; both are on the same scale (CIE 15:2004, 8.2.1).
#[must_use]
pub fn lab(xyz: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let f = |t: f64| {
        if t > (6.0 / 29.0) * (6.0 / 29.0) * (6.0 / 29.0) { libm::cbrt(t) } else { 841.0 / 108.0 * t + 4.0 / 29.0 }
    };
    let [x, y, z] = [0, 1, 2].map(|i| f(xyz[i] / white[i]));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Converts CIE 1976 L*, a*, b* to XYZ on the scale of `white`: the inverse of [`lab()`].
#[must_use]
pub fn xyz_of_lab(lab: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let inverse = |f: f64| {
        if f > 6.0 / 29.0 { f * f * f } else { 108.0 / 841.0 * (f - 4.0 / 29.0) }
    };
    let y = (lab[0] + 16.0) / 116.0;
    let f = [y + lab[1] / 500.0, y, y - lab[2] / 200.0];
    [0, 1, 2].map(|i| inverse(f[i]) * white[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_has_l_100_and_no_chroma() {
        let white = [96.42, 100.0, 82.51];
        assert_eq!(lab(white, white), [100.0, 0.0, 0.0]);
        assert_eq!(lab([0.0; 3], white), [0.0, 0.0, 0.0]);
        assert!(chromaticity([0.0; 3]).is_none() && chromaticity([f64::NAN; 3]).is_none());
    }

    #[test]
    fn lab_inverts_on_both_branches() {
        let white = [95.047, 100.0, 108.883];
        for xyz in [[50.0, 40.0, 3.0], [0.1, 0.2, 0.05], [0.5, 0.8856, 90.0]] {
            let back = xyz_of_lab(lab(xyz, white), white);
            assert!(back.iter().zip(xyz).all(|(a, b)| (a - b).abs() < 1e-12), "{back:?}");
        }
    }

    #[test]
    fn no_light_no_color() {
        let dark = Emission::line(1064.0, 1.0).expect("valid");
        let grey = Reflectance::constant(0.18).expect("valid");
        let observer = Observer::cie_1931_2deg();
        assert!(xyz_of_light(&dark, observer).is_none() && xyz_of_reflectance(&grey, &dark, observer).is_none());
        let lit = xyz_of_reflectance(&grey, &Emission::line(550.0, 2.0).expect("valid"), observer).expect("light");
        assert!((lit[1] - 18.0).abs() < 1e-12);
    }
}
