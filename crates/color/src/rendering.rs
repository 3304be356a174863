//! Color rendering: compares the colors of test samples under a lamp with those under a reference light of its color temperature.

use crate::adaptation::Adaptation;
use crate::cct::{cct, uv_1960};
use crate::colorimetry::{chromaticity, xyz_of_light, xyz_of_reflectance};
use spectra_core::spectral::{BAND, Grid, Line, SpectralPower};
use spectra_spectrum::{Emission, Observer, Reflectance, daylight, find_reflectance};
use std::sync::OnceLock;

/// The CIE color rendering indices of a lamp.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorRendering {
    /// General index Ra: the mean of the first eight special indices; 100 for the reference.
    pub ra: f64,
    /// Special indices R1 to R14, in order.
    pub special: Vec<f64>,
    /// Correlated color temperature of the lamp and of its reference, K.
    pub kelvin: f64,
}

/// The color fidelity of a lamp relative to its reference (CIE 224:2017).
#[derive(Clone, Debug, PartialEq)]
pub struct Fidelity {
    /// Fidelity index Rf, 0 to 100.
    pub rf: f64,
    /// Fidelity of each of the 99 samples, 0 to 100.
    pub samples: Vec<f64>,
}

fn samples(table: &str, column: impl Fn(usize) -> String, count: usize) -> Vec<Reflectance> {
    (1..=count)
        .map(|i| {
            let name = format!("{table}#{}", column(i));
            find_reflectance(&name).unwrap_or_else(|e| panic!("{name} is bundled: {e}"))
        })
        .collect()
}

/// Returns the fourteen test colors of CIE 13.3-1995.
#[must_use]
pub fn cie_test_colors() -> &'static [Reflectance] {
    static ONE: OnceLock<Vec<Reflectance>> = OnceLock::new();
    ONE.get_or_init(|| samples("spectra/reflectances/cie-test-colors.csv", |i| format!("tcs{i:02}"), 14))
}

/// Returns the 99 color evaluation samples of CIE 224:2017 and ANSI/IES TM-30.
#[must_use]
pub fn color_evaluation_samples() -> &'static [Reflectance] {
    static ONE: OnceLock<Vec<Reflectance>> = OnceLock::new();
    ONE.get_or_init(|| samples("spectra/reflectances/color-evaluation-samples.csv", |i| format!("ces{i:02}"), 99))
}

/// Computes the general and special color rendering indices of `light` (CIE 13.3-1995), on 350-830 nm in steps of 1 nm. Spectral lines keep
/// their own wavelengths.
///
/// The reference is a black body below 5000 K and CIE daylight from there on. Returns `None` for a light without a correlated color
/// temperature, and above 25 000 K, where CIE daylight is not defined.
#[must_use]
pub fn color_rendering(light: &Emission) -> Option<ColorRendering> {
    let observer = Observer::cie_1931_2deg();
    let test_white = xyz_of_light(light, observer)?;
    let kelvin = cct(chromaticity(test_white)?)?.kelvin;
    let reference = if kelvin < 5000.0 { Emission::blackbody(kelvin) } else { daylight(kelvin) }.ok()?;
    let reference_white = xyz_of_light(&reference, observer)?;
    let uv = |xyz: [f64; 3]| chromaticity(xyz).map(uv_1960);
    let (test_uv, reference_uv) = (uv(test_white)?, uv(reference_white)?);
    // CIE 13.3-1995, 5.7: adaptation of the von Kries type in the coordinates of the CIE 1960 diagram.
    let c = |[u, v]: [f64; 2]| (4.0 - u - 10.0 * v) / v;
    let d = |[u, v]: [f64; 2]| (1.708 * v + 0.404 - 1.481 * u) / v;
    let (c_ratio, d_ratio) = (c(reference_uv) / c(test_uv), d(reference_uv) / d(test_uv));
    let adapted = |at: [f64; 2]| {
        let (c, d) = (c_ratio * c(at), d_ratio * d(at));
        let divisor = 16.518 + 1.481 * c - d;
        [(10.872 + 0.404 * c - 4.0 * d) / divisor, 5.52 / divisor]
    };
    // CIE 1964 U*, V*, W*.
    let uvw = |y: f64, [u, v]: [f64; 2]| {
        let w = 25.0 * libm::cbrt(y) - 17.0;
        [13.0 * w * (u - reference_uv[0]), 13.0 * w * (v - reference_uv[1]), w]
    };
    let special = |sample: &Reflectance| {
        let test = xyz_of_reflectance(sample, light, observer)?;
        let under_reference = xyz_of_reflectance(sample, &reference, observer)?;
        let test = uvw(test[1], adapted(uv(test)?));
        let under_reference = uvw(under_reference[1], uv(under_reference)?);
        Some(100.0 - 4.6 * distance(test, under_reference))
    };
    let special: Vec<f64> = cie_test_colors().iter().map(special).collect::<Option<_>>()?;
    Some(ColorRendering { ra: special[..8].iter().sum::<f64>() / 8.0, special, kelvin })
}

/// Computes the color fidelity index Rf of `light` (CIE 224:2017, ANSI/IES TM-30-18 and later), on 380-780 nm.
/// The step is 5 nm for a light without lines that is tabulated every 5 nm, as the CIE specifies, and otherwise 1 nm. Spectral lines keep
/// their own wavelengths.
///
/// The reference is a black body up to 4000 K, CIE daylight from 5000 K on, and between them a mixture of both at equal luminance. Returns
/// `None` for a light without a correlated color temperature, and above 25 000 K.
#[must_use]
pub fn fidelity(light: &Emission) -> Option<Fidelity> {
    let by_five = light.lines().is_empty() && light.continuum().is_some_and(|c| c.spacing_nm() == 5.0);
    let (step_nm, count) = if by_five { (5.0, 81) } else { (1.0, 401) };
    let grid = Grid { start_nm: 380.0, step_nm, count };
    let test = light.to_power(&grid);
    let xyz = Observer::cie_1931_2deg().xyz_of_power(&test);
    let reference = fidelity_reference(cct(chromaticity(xyz)?)?.kelvin)?.to_power(&grid);
    let samples: Vec<(&Reflectance, Vec<f64>)> =
        color_evaluation_samples().iter().map(|sample| (sample, sample.on_grid(&grid))).collect();
    let observer = Observer::cie_1964_10deg();
    let seen = |light: &SpectralPower| -> Option<Vec<[f64; 3]>> {
        let white = observer.xyz_of_power(light);
        let scale = 100.0 / white[1];
        if !(scale > 0.0 && scale.is_finite()) {
            return None;
        }
        let of = |(sample, values): &(&Reflectance, Vec<f64>)| {
            let continuum = light.continuum.iter().zip(values).map(|(p, r)| p * r).collect();
            let lines = light.lines.iter().map(|l| Line { power: l.power * sample.at(l.wavelength_nm), ..*l });
            let reflected = SpectralPower { grid, continuum, lines: lines.collect() };
            cam02_ucs(observer.xyz_of_power(&reflected).map(|v| scale * v), white.map(|v| scale * v))
        };
        Some(samples.iter().map(of).collect())
    };
    let apart: Vec<f64> = seen(&test)?.into_iter().zip(seen(&reference)?).map(|(a, b)| distance(a, b)).collect();
    let mean = apart.iter().sum::<f64>() / apart.len() as f64;
    Some(Fidelity { rf: fidelity_index(mean), samples: apart.into_iter().map(fidelity_index).collect() })
}

/// Converts a color difference in CAM02-UCS, or the mean of several, to a fidelity index from 100 down to 0 (CIE 224:2017, 4.6).
#[must_use]
pub fn fidelity_index(difference: f64) -> f64 {
    10.0 * libm::log1p(libm::exp((100.0 - 6.73 * difference) / 10.0))
}

fn fidelity_reference(kelvin: f64) -> Option<Emission> {
    let even = |light: Emission| light.scaled_to_luminance(100.0).ok();
    if kelvin <= 4000.0 {
        return even(Emission::blackbody(kelvin).ok()?);
    }
    let day = even(daylight(kelvin).ok()?)?;
    if kelvin >= 5000.0 {
        return Some(day);
    }
    let share = (kelvin - 4000.0) / 1000.0;
    let body = even(Emission::blackbody(kelvin).ok()?)?;
    Some(body.scaled(1.0 - share).ok()? + day.scaled(share).ok()?)
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Computes J', a', b' of CAM02-UCS for `xyz` seen against `white`, where the white has Y = 100.
/// The viewing conditions are those of CIE 224:2017: adapting luminance 100 cd/m2, background 20, average surround, complete adaptation.
/// Sources: CIE 159:2004; M. R. Luo, G. Cui, C. Li, Color Research & Application 31, 320 (2006).
#[must_use]
pub fn cam02_ucs(xyz: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    const ADAPTING_CD_M2: f64 = 100.0;
    const BACKGROUND: f64 = 20.0;
    const SURROUND_C: f64 = 0.69;
    const INDUCTION: f64 = 1.0;
    let five = 5.0 * ADAPTING_CD_M2;
    let k = 1.0 / (five + 1.0);
    let k4 = k * k * k * k;
    let level = 0.2 * k4 * five + 0.1 * (1.0 - k4) * (1.0 - k4) * libm::cbrt(five);
    let n = BACKGROUND / white[1];
    let n_bb = 0.725 * libm::pow(1.0 / n, 0.2);
    let z = 1.48 + n.sqrt();
    let cat02 = Adaptation::Cat02;
    // Adapts to equal energy, then compresses the cone responses of Hunt, Pointer and Estevez.
    let cones = |xyz: [f64; 3]| {
        let [x, y, z] = cat02.adapt(xyz, white, [white[1]; 3]);
        let hpe = [0.38971 * x + 0.68898 * y - 0.07868 * z, -0.22981 * x + 1.18340 * y + 0.04641 * z, z];
        hpe.map(|v| {
            let p = libm::pow(level * v.abs() / 100.0, 0.42);
            400.0 * (p / (p + 27.13)).copysign(v) + 0.1
        })
    };
    let achromatic = |[r, g, b]: [f64; 3]| (2.0 * r + g + b / 20.0 - 0.305) * n_bb;
    let [r, g, b] = cones(xyz);
    let (a, b_axis) = (r - 12.0 * g / 11.0 + b / 11.0, (r + g - 2.0 * b) / 9.0);
    let hue = libm::atan2(b_axis, a);
    let lightness = 100.0 * libm::pow(achromatic([r, g, b]) / achromatic(cones(white)), SURROUND_C * z);
    let eccentricity = 0.25 * (libm::cos(hue + 2.0) + 3.8);
    let t = 50_000.0 / 13.0 * INDUCTION * n_bb * eccentricity * libm::hypot(a, b_axis) / (r + g + 1.05 * b);
    let chroma = libm::pow(t, 0.9) * (lightness / 100.0).sqrt() * libm::pow(1.64 - libm::pow(0.29, n), 0.73);
    let colorfulness = chroma * libm::pow(level, 0.25);
    let bent = libm::log1p(0.0228 * colorfulness) / 0.0228;
    [1.7 * lightness / (1.0 + 0.007 * lightness), bent * libm::cos(hue), bent * libm::sin(hue)]
}

/// Computes the luminous efficacy of `light`, lm/W: luminance divided by power over 350-830 nm. `None` if the power is not positive and
/// finite.
#[must_use]
pub fn luminous_efficacy(light: &Emission) -> Option<f64> {
    let power = light.power(&BAND);
    (power > 0.0 && power.is_finite()).then(|| light.luminance() / power)
}

/// Converts the CIE 1931 chromaticity x, y to CIE 1976 u', v'.
#[must_use]
pub fn uv_1976(xy: [f64; 2]) -> [f64; 2] {
    let [u, v] = uv_1960(xy);
    [u, 1.5 * v]
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_spectrum::find_emission;

    /// A reference light renders fully, by definition. Values of real lamps are compared with colour-science below.
    #[test]
    fn references_render_fully() {
        for name in ["blackbody:2856", "A", "D65", "D50", "daylight:7000"] {
            let light = find_emission(name).expect("bundled");
            let [ra, rf] = [color_rendering(&light).expect("white").ra, fidelity(&light).expect("white").rf];
            assert!(ra > 99.5 && ra < 100.0001, "{name}: Ra {ra}");
            assert!(rf > 99.5 && rf < 100.01, "{name}: Rf {rf}");
        }
        for none in ["line:555", "led:450,20", "line:t"] {
            let light = find_emission(none).expect("a light");
            assert!(color_rendering(&light).is_none() && fidelity(&light).is_none(), "{none}");
        }
    }

    /// Compares CIE 13.3 and CIE 224 on F1 to F12 with colour-science 0.4.7 (see `xtask/import_colour_science.py`): within 0.05.
    #[test]
    fn lamps_render_as_an_independent_program_has_it() {
        let mut worst = [0.0_f64; 2];
        let table = include_str!("../tests/data/rendering.csv");
        for line in table.lines().filter(|line| !line.starts_with('#')).skip(1) {
            let cells: Vec<&str> = line.split(',').collect();
            let numbers: Vec<f64> = cells[1..].iter().map(|cell| cell.parse().expect("a number")).collect();
            let light = find_emission(cells[0]).expect("bundled");
            let rendering = color_rendering(&light).expect("white");
            let rf = fidelity(&light).expect("white").rf;
            let off = [(rendering.ra - numbers[0]).abs(), (rf - numbers[1]).abs()];
            println!("{}: Ra {:.3} ({}), Rf {rf:.3} ({})", cells[0], rendering.ra, numbers[0], numbers[1]);
            worst = [worst[0].max(off[0]), worst[1].max(off[1])];
        }
        println!("worst {worst:?}");
        assert!(worst[0] < 0.05 && worst[1] < 0.05, "{worst:?}");
    }
}
