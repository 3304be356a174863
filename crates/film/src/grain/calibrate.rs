//! From RMS granularity to the size of a grain.

use spectra_core::math::acos;
use std::f64::consts::{LOG10_E, PI};

/// Diameter of the aperture that defines RMS granularity, mm.
pub const APERTURE_MM: f64 = 0.048;

/// A granularity that is none.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GrainError {
    /// Out of range.
    #[error("an RMS granularity lies between 0 and 200 (1000 times the deviation of the density), not {0}")]
    OutOfRange(f64),
}

pub(super) struct Calibration {
    /// Variance of the density 1 times the area, mm^2.
    pub(super) selwyn_mm2: f64,
    /// Side of the finest cells, mm.
    pub(super) cell_mm: f64,
}

/// The size of grains that have `rms_granularity`.
pub(super) fn calibrate(rms_granularity: f64) -> Result<Calibration, GrainError> {
    if !(0.0..=200.0).contains(&rms_granularity) {
        return Err(GrainError::OutOfRange(rms_granularity));
    }
    let area = PI / 4.0 * APERTURE_MM * APERTURE_MM;
    let deviation = rms_granularity / 1000.0;
    let ideal = deviation * deviation * area;
    // A cell is as wide as a round grain of Nutting's area.
    let cell_mm = (4.0 / PI * ideal / LOG10_E).sqrt();
    let selwyn_mm2 = if ideal > 0.0 { ideal / kept_variance(cell_mm, APERTURE_MM) } else { 0.0 };
    Ok(Calibration { selwyn_mm2, cell_mm })
}

/// Variance through a round aperture over that of grains that were points: cells spread by a quadratic B-spline
/// are correlated by the quintic one, and the mean of that over pairs of points in the aperture is what is left.
pub(super) fn kept_variance(cell_mm: f64, aperture_mm: f64) -> f64 {
    const STEPS: i32 = 240;
    let step = 6.0 / f64::from(STEPS);
    let place = |i: i32| (f64::from(i) + 0.5) * step - 3.0;
    let (mut sum, mut weight) = (0.0, 0.0);
    for j in 0..STEPS {
        for i in 0..STEPS {
            let (x, y) = (place(i), place(j));
            let w = quintic(x) * quintic(y);
            // Part of a disk that lies in the same disk moved by r.
            let r = ((x * x + y * y).sqrt() * cell_mm / aperture_mm).min(1.0);
            sum += w * 2.0 / PI * (acos(r) - r * (1.0 - r * r).sqrt());
            weight += w;
        }
    }
    sum / weight
}

/// The quintic B-spline around 0, the correlation of the quadratic one with itself.
fn quintic(x: f64) -> f64 {
    let binomials = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
    let power = |t: f64| if t > 0.0 { t * t * t * t * t } else { 0.0 };
    binomials.iter().enumerate().map(|(k, b)| b * power(3.0 - x.abs() - k as f64)).sum::<f64>() / 120.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nutting's and Selwyn's laws by hand: 17 through 48 um is an area of 1.2 um^2.
    #[test]
    fn calibration_is_nuttings_and_selwyns() {
        let calibration = calibrate(17.0).unwrap();
        let grain_um2 = calibration.selwyn_mm2 / LOG10_E * 1e6;
        assert!((grain_um2 / 1.204 - 1.0).abs() < 0.04, "{grain_um2}");
        assert!((calibration.cell_mm * 1e3 - 1.238).abs() < 0.001, "{}", calibration.cell_mm);
        assert_eq!(calibrate(0.0).unwrap().selwyn_mm2, 0.0);
        for bad in [-1.0, 201.0, f64::NAN] {
            assert!(calibrate(bad).is_err());
        }
    }

    /// Small cells: 1 - (4 / (pi d)) E(r), where r is close to Rayleigh's of the deviation h / sqrt(2) an axis.
    #[test]
    fn little_variance_is_lost_over_large_apertures() {
        let lost = 1.0 - kept_variance(0.001, 0.1);
        let want = 4.0 / PI * (PI / 2.0).sqrt() * 0.5_f64.sqrt() * 0.01;
        assert!((lost / want - 1.0).abs() < 0.02, "{lost} {want}");
    }
}
