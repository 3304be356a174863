//! Correlated color temperature of a chromaticity.

use spectra_core::spectral::{BAND, SpectralPower};
use spectra_spectrum::{Observer, planck_radiance};
use std::sync::OnceLock;

/// Correlated color temperature and the distance from the Planckian locus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cct {
    /// Temperature of the black body whose chromaticity is nearest in the CIE 1960 diagram, K.
    pub kelvin: f64,
    /// Distance from that black body in the CIE 1960 diagram; positive above the locus (greenish).
    pub duv: f64,
}

/// Largest distance from the locus at which a color temperature is meaningful (CIE 15:2004, 9.5).
const LARGEST_DUV: f64 = 0.05;
/// Range of reciprocal temperatures that is searched, per MK: 1 000 000 K to 800 K.
const MIRED: (f64, f64) = (1.0, 1250.0);
/// Number of points of the coarse search. The locus bends so slowly that the best temperature lies next to the nearest of these points.
const POINTS: usize = 251;

/// Converts the CIE 1931 chromaticity x, y to CIE 1960 u, v.
#[must_use]
pub fn uv_1960(xy: [f64; 2]) -> [f64; 2] {
    let d = -2.0 * xy[0] + 12.0 * xy[1] + 3.0;
    [4.0 * xy[0] / d, 6.0 * xy[1] / d]
}

/// XYZ of a black body for the 1931 observer, 350-830 nm in steps of 1 nm, without a normalizing factor.
fn planckian_xyz(temperature_k: f64) -> [f64; 3] {
    let continuum = BAND.wavelengths_nm().map(|w| planck_radiance(w, temperature_k)).collect();
    Observer::cie_1931_2deg().xyz_of_power(&SpectralPower { grid: BAND, continuum, lines: Vec::new() })
}

fn planckian_uv(mired: f64) -> [f64; 2] {
    let [x, y, z] = planckian_xyz(1e6 / mired);
    uv_1960([x / (x + y + z), y / (x + y + z)])
}

fn mired_of(point: usize) -> f64 {
    MIRED.0 + (MIRED.1 - MIRED.0) * point as f64 / (POINTS - 1) as f64
}

fn locus() -> &'static [[f64; 2]] {
    static ONE: OnceLock<Vec<[f64; 2]>> = OnceLock::new();
    ONE.get_or_init(|| (0..POINTS).map(|i| planckian_uv(mired_of(i))).collect())
}

/// Computes the correlated color temperature of the chromaticity `xy` by its definition.
/// This is the temperature at the nearest point of the Planckian locus on the CIE 1960 diagram, with the exact radiation constants.
///
/// Returns `None` if the distance from the locus exceeds 0.05, or if the temperature is outside 800 K to 1 000 000 K.
#[must_use]
pub fn cct(xy: [f64; 2]) -> Option<Cct> {
    let [u, v] = uv_1960(xy);
    let square = |p: [f64; 2]| (u - p[0]) * (u - p[0]) + (v - p[1]) * (v - p[1]);
    let nearest = (0..POINTS).min_by(|a, b| square(locus()[*a]).total_cmp(&square(locus()[*b])))?;
    if nearest == 0 || nearest == POINTS - 1 || !square(locus()[nearest]).is_finite() {
        return None;
    }
    // Where the distance is smallest, its derivative along the locus changes sign. Bisection on the derivative finds this point to full
    // precision; comparing distances would lose half the digits.
    let slope = |mired: f64| {
        let step = 1e-3 * mired;
        let (before, at, after) = (planckian_uv(mired - step), planckian_uv(mired), planckian_uv(mired + step));
        (at[0] - u) * (after[0] - before[0]) + (at[1] - v) * (after[1] - before[1])
    };
    let (mut low, mut high) = (mired_of(nearest - 1), mired_of(nearest + 1));
    while high - low > 1e-7 * low {
        let middle = 0.5 * (low + high);
        if slope(middle) < 0.0 { low = middle } else { high = middle }
    }
    let mired = 0.5 * (low + high);
    let at = planckian_uv(mired);
    let duv = square(at).sqrt().copysign(v - at[1]);
    (duv.abs() <= LARGEST_DUV).then(|| Cct { kelvin: 1e6 / mired, duv })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chromaticity;
    use spectra_spectrum::Emission;

    /// Compares Planckian chromaticities with independently computed 1 nm sums over 360-830 nm.
    #[test]
    fn planckian_chromaticities() {
        for (kelvin, x, y) in [
            (1000.0, 0.65275, 0.34446),
            (2000.0, 0.52668, 0.41330),
            (2856.0, 0.44754, 0.40743),
            (3000.0, 0.43693, 0.40408),
            (4000.0, 0.38044, 0.37675),
            (5000.0, 0.34510, 0.35161),
            (6500.0, 0.31353, 0.32363),
            (10_000.0, 0.28063, 0.28829),
        ] {
            let body = Emission::blackbody(kelvin).expect("positive");
            let [gx, gy] = chromaticity(Observer::cie_1931_2deg().xyz(&body)).expect("light");
            assert!((gx - x).abs() < 1e-4 && (gy - y).abs() < 1e-4, "{kelvin}: {gx} {gy}");
        }
    }

    #[test]
    fn a_black_body_has_its_own_temperature() {
        for kelvin in [900.0, 1000.0, 2000.0, 2856.0, 5000.0, 6503.6, 25_000.0, 100_000.0] {
            let xy = chromaticity(planckian_xyz(kelvin)).expect("light");
            let got = cct(xy).expect("on the locus");
            assert!((got.kelvin / kelvin - 1.0).abs() < 1e-5 && got.duv.abs() < 1e-8, "{kelvin}: {got:?}");
        }
    }

    #[test]
    fn colors_have_no_temperature() {
        for xy in [[0.15, 0.06], [0.3, 0.6], [f64::NAN, 0.3]] {
            assert_eq!(cct(xy), None, "{xy:?}");
        }
    }
}
