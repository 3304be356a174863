//! Three emission spectra whose colors are exactly the primaries of sRGB.
//!
//! A color has infinitely many spectra. This module searches for all three spectra together, among those that are nowhere negative, fall to
//! 0 at both ends of the band and have the XYZ of the primaries.
//! It takes the spectra with the smallest integral of squared slope. The slope of their sum counts three times, so that white is a smooth
//! spectrum and not a comb of three bands.
//!
//! The spectra are cubic B-splines with a knot every 10 nm. Slopes are differences of neighboring coefficients, and no coefficient is
//! negative.
//! This is a quadratic program of 135 unknowns with nine equations. An active-set method solves it to roundoff: it holds coefficients at 0
//! that would become negative, and releases those that would rise.

use crate::rgb::RgbSpace;
use spectra_core::spectral::BAND;
use spectra_numerics::linear;
use spectra_spectrum::{Emission, Observer, Outside, Scale, SpectrumError, Tabulated};
use std::sync::OnceLock;

/// Distance between knots (nm) and number of splines that lie wholly on the band.
const KNOT_NM: f64 = 10.0;
const SPLINES: usize = 45;
/// Numbers of unknowns (the coefficients of red, green and blue, in this order) and of equations.
const UNKNOWNS: usize = 3 * SPLINES;
const EQUATIONS: usize = 9;
/// Weight of the slope of the sum, relative to the slope of each spectrum.
const WEIGHT_OF_SUM: f64 = 3.0;
/// Limit on the number of rounds, far above the 10 that are needed.
const MAX_ROUNDS: usize = 100;

/// Returns emission spectra of the red, green and blue primaries of sRGB (CIE 1931, 350-830 nm in steps of 1 nm).
///
/// Their sum, weighted by linear sRGB values, has exactly the color of these values, where white has Y = 1. See [`srgb_light`].
#[must_use]
pub fn srgb_primaries() -> &'static [Emission; 3] {
    static ONE: OnceLock<[Emission; 3]> = OnceLock::new();
    ONE.get_or_init(|| {
        let wavelengths: Vec<f64> = BAND.wavelengths_nm().collect();
        spectra(RgbSpace::srgb()).map(|values| {
            let table = Tabulated::new(&wavelengths, &values, Outside::Zero, Scale::Linear);
            table.and_then(Emission::tabulated).expect("splines of coefficients that are not negative")
        })
    })
}

/// Returns light of the color `linear_srgb`: the sum of the three primaries, each multiplied by its value.
///
/// # Errors
/// [`SpectrumError::OutOfRange`] if a value is negative or not finite.
pub fn srgb_light(linear_srgb: [f64; 3]) -> Result<Emission, SpectrumError> {
    let [red, green, blue] = srgb_primaries();
    let [r, g, b] = linear_srgb;
    Ok(red.scaled(r)? + green.scaled(g)? + blue.scaled(b)?)
}

/// Evaluates the cubic B-spline around 0 whose knots are 1 apart.
fn spline(t: f64) -> f64 {
    let t = t.abs();
    if t < 1.0 {
        (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0
    } else if t < 2.0 {
        (2.0 - t) * (2.0 - t) * (2.0 - t) / 6.0
    } else {
        0.0
    }
}

/// Samples spline `k` at the wavelengths of the band.
fn on_band(k: usize) -> impl Iterator<Item = f64> {
    // The first spline starts at the start of the band, two knots below its center.
    let center = BAND.start_nm + KNOT_NM * (k + 2) as f64;
    (0..BAND.count).map(move |i| spline((BAND.wavelength_nm(i) - center) / KNOT_NM))
}

fn spectra(space: &RgbSpace) -> [Vec<f64>; 3] {
    let functions = Observer::cie_1931_2deg().on_grid(&BAND);
    // XYZ of each spline, by the defining sum over the points of the band.
    let xyz: Vec<[f64; 3]> = (0..SPLINES)
        .map(|k| {
            let seen = |f: &Vec<f64>| on_band(k).zip(f).map(|(b, f)| b * f).sum::<f64>() * BAND.step_nm;
            [seen(&functions[0]), seen(&functions[1]), seen(&functions[2])]
        })
        .collect();
    let coefficients = program(&xyz, &space.xyz_from_rgb);
    [0, 1, 2].map(|channel| {
        let mut values = vec![0.0; BAND.count];
        for k in 0..SPLINES {
            let c = coefficients[channel * SPLINES + k];
            values.iter_mut().zip(on_band(k)).for_each(|(v, b)| *v += c * b);
        }
        values
    })
}

/// Half the second derivative of the roughness with respect to the coefficients `i` and `j`.
fn roughness(i: usize, j: usize) -> f64 {
    let (a, b) = (i % SPLINES, j % SPLINES);
    let neighbors = match a.abs_diff(b) {
        0 => 2.0,
        1 => -1.0,
        _ => 0.0,
    };
    let same = if i / SPLINES == j / SPLINES { 1.0 } else { 0.0 };
    neighbors * (same + WEIGHT_OF_SUM)
}

/// Finds the coefficients of least roughness whose spectra have the XYZ in the columns of `wanted`.
fn program(xyz: &[[f64; 3]], wanted: &[[f64; 3]; 3]) -> Vec<f64> {
    // Equation 3 c + x fixes component x of channel c.
    let equation = |e: usize, i: usize| if i / SPLINES == e / 3 { xyz[i % SPLINES][e % 3] } else { 0.0 };
    let mut held = [false; UNKNOWNS];
    for _ in 0..MAX_ROUNDS {
        let free: Vec<usize> = (0..UNKNOWNS).filter(|i| !held[*i]).collect();
        let n = free.len();
        let size = n + EQUATIONS;
        let (mut matrix, mut right) = (vec![0.0; size * size], vec![0.0; size]);
        for (row, i) in free.iter().enumerate() {
            for (column, j) in free.iter().enumerate() {
                matrix[row * size + column] = roughness(*i, *j);
            }
            for e in n..size {
                matrix[row * size + e] = equation(e - n, *i);
                matrix[e * size + row] = matrix[row * size + e];
            }
        }
        for e in 0..EQUATIONS {
            right[n + e] = wanted[e % 3][e / 3];
        }
        let solution = linear::solve(&matrix, &right).expect("three splines a channel are free, and independent");
        let mut coefficients = vec![0.0; UNKNOWNS];
        free.iter().zip(&solution).for_each(|(i, c)| coefficients[*i] = *c);
        let below: Vec<usize> = (0..UNKNOWNS).filter(|i| coefficients[*i] < 0.0).collect();
        if !below.is_empty() {
            below.iter().for_each(|i| held[*i] = true);
            continue;
        }
        // Rate at which the roughness changes if a held coefficient rises; negative if it should be released.
        let cost = |i: usize| {
            let slope: f64 = (0..UNKNOWNS).map(|j| roughness(i, j) * coefficients[j]).sum();
            slope + (0..EQUATIONS).map(|e| equation(e, i) * solution[n + e]).sum::<f64>()
        };
        let held_now = (0..UNKNOWNS).filter(|i| held[*i]).map(|i| (i, cost(i)));
        match held_now.min_by(|a, b| a.1.total_cmp(&b.1)) {
            // Coefficients are about 0.01, and so is the cost of a step.
            Some((i, cost)) if cost < -1e-12 => held[i] = false,
            _ => return coefficients,
        }
    }
    unreachable!("each round lowers the roughness, or raises the number of those held")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chromaticity;

    /// Checks IEC 61966-2-1: primaries (.64, .33), (.30, .60), (.15, .06), white D65 (.3127, .3290), luminances that add up to 1.
    #[test]
    fn primaries_and_white_are_those_of_srgb() {
        let observer = Observer::cie_1931_2deg();
        let colors = [
            ([1.0, 0.0, 0.0], [0.64, 0.33]),
            ([0.0, 1.0, 0.0], [0.30, 0.60]),
            ([0.0, 0.0, 1.0], [0.15, 0.06]),
            ([1.0, 1.0, 1.0], [0.3127, 0.3290]),
        ];
        for (rgb, xy) in colors {
            let got = chromaticity(observer.xyz(&srgb_light(rgb).expect("valid"))).expect("light");
            assert!((got[0] - xy[0]).abs() < 1e-12 && (got[1] - xy[1]).abs() < 1e-12, "{rgb:?} {got:?}");
        }
        let white = observer.xyz(&srgb_light([1.0; 3]).expect("valid"));
        assert!((white[1] - 1.0).abs() < 1e-12, "{white:?}");
    }

    /// Converts linear RGB to light to XYZ and back: agrees within 1e-9 everywhere in the cube, and above 1.
    #[test]
    fn srgb_round_trip_is_exact() {
        let observer = Observer::cie_1931_2deg();
        let mut worst = 0.0_f64;
        let steps = [0.0, 1e-4, 0.02, 0.18, 0.5, 1.0, 40.0];
        for r in steps {
            for g in steps {
                for b in steps {
                    let light = srgb_light([r, g, b]).expect("valid");
                    let back = RgbSpace::srgb().from_xyz(observer.xyz(&light));
                    for (x, y) in back.iter().zip([r, g, b]) {
                        worst = worst.max((x - y).abs() / (1.0 + y));
                    }
                }
            }
        }
        println!("largest difference in linear RGB: {worst:e}");
        assert!(worst < 1e-9, "{worst:e}");
    }

    /// The primaries are nowhere negative, zero at the ends of the band, and without jumps: steps of 1 nm change by at most 3 % of the
    /// peak.
    #[test]
    fn primaries_are_smooth_light() {
        for (light, range) in srgb_primaries().iter().zip([600.0..700.0, 500.0..560.0, 430.0..470.0]) {
            let values = light.on_grid(&BAND);
            let peak = values.iter().fold(0.0_f64, |a, v| a.max(*v));
            let at = values.iter().position(|v| *v == peak).expect("a peak");
            assert!(range.contains(&BAND.wavelength_nm(at)), "{}", BAND.wavelength_nm(at));
            assert!(values.iter().all(|v| *v >= 0.0));
            assert!(values[0] == 0.0 && values[BAND.count - 1] < 1e-15 * peak);
            assert!(values.windows(2).all(|w| (w[1] - w[0]).abs() < 0.03 * peak));
        }
        // The sum of the primaries has no gap: over the well-visible range it never falls below two thirds of its mean.
        let white = srgb_light([1.0; 3]).expect("valid").on_grid(&BAND);
        let seen = &white[70..330];
        let mean = seen.iter().sum::<f64>() / seen.len() as f64;
        assert!(seen.iter().all(|v| (0.66 * mean..1.4 * mean).contains(v)));
    }

    #[test]
    fn negative_light_is_refused() {
        assert!(srgb_light([1.0, -0.1, 0.0]).is_err() && srgb_light([f64::NAN, 0.0, 0.0]).is_err());
    }
}
