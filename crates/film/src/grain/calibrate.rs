//! Derives the size of grains and their clumps from RMS granularity.

use crate::cache::Cache;
use spectra_core::math::{acos, sin};
use std::f64::consts::PI;

/// Diameter of the aperture that defines RMS granularity, mm.
pub const APERTURE_MM: f64 = 0.048;

/// A granularity or spectrum that is out of range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GrainError {
    /// The RMS granularity is out of range.
    #[error("an RMS granularity must be 0 to 200 (1000 times the deviation of the density), not {0}")]
    OutOfRange(f64),
    /// The frequency of half power is out of range.
    #[error("the Wiener spectrum must fall to half between 1 and 1000 cycles/mm, not at {0}")]
    HalfPower(f64),
}

/// Share of single crystals in the noise of large areas; the rest lies in clumps.
pub(super) const CRYSTALS: f64 = 0.12;

/// Width of a clump, in widths of a crystal.
pub(super) const CLUMP: f64 = 5.0;

/// Side of the cells of clumps (mm) for a Wiener spectrum that falls to half at `half_power` cycles/mm.
pub(super) fn clump_mm(half_power: f64) -> Result<f64, GrainError> {
    if !(1.0..=1000.0).contains(&half_power) {
        return Err(GrainError::HalfPower(half_power));
    }
    let (mut left, mut right) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (left + right);
        if wiener(middle) > 0.5 { left = middle } else { right = middle }
    }
    Ok(left / half_power)
}

/// Wiener spectrum relative to its value at 0, at `f` cycles per clump, along an axis: cells spread by a quadratic B-spline have sinc^6.
pub(super) fn wiener(f: f64) -> f64 {
    let spline = |f: f64| {
        let x = PI * f;
        let sinc = if x == 0.0 { 1.0 } else { sin(x) / x };
        sinc * sinc * sinc * sinc * sinc * sinc
    };
    (1.0 - CRYSTALS) * spline(f) + CRYSTALS * spline(f / CLUMP)
}

/// Pixel size (mm) at which the aperture is assumed to be read: between the finest and the coarsest that hold a film's grain.
/// Finer pixels read up to 2 % more, pixels of 8 um up to 2 % less.
const READ_MM: f64 = 0.005;

/// Variance times area (mm^2) of large areas, divided by the square of the deviation through the 48 um aperture.
pub(super) fn selwyn_mm2(clump_mm: f64) -> f64 {
    static KNOWN: Cache<u64, f64> = Cache::new();
    *KNOWN.get_or_compute(clump_mm.to_bits(), || found_selwyn_mm2(clump_mm))
}

fn found_selwyn_mm2(clump_mm: f64) -> f64 {
    // A pixel averages, and lies only partly inside at the edge of the aperture: two more boxes, to the second order. A quadratic spline
    // has the variance h^2 / 4, a box p^2 / 12.
    let kept = |cell_mm: f64| kept_variance((cell_mm * cell_mm + 2.0 / 3.0 * READ_MM * READ_MM).sqrt(), APERTURE_MM);
    PI / 4.0 * APERTURE_MM * APERTURE_MM / ((1.0 - CRYSTALS) * kept(clump_mm) + CRYSTALS * kept(clump_mm / CLUMP))
}

/// Variance through a round aperture, relative to that of point-like grains. Cells spread by a quadratic B-spline are correlated by the
/// quintic one; the result is the mean of this over pairs of points in the aperture.
pub(super) fn kept_variance(cell_mm: f64, aperture_mm: f64) -> f64 {
    const STEPS: i32 = 240;
    let step = 6.0 / f64::from(STEPS);
    let place = |i: i32| (f64::from(i) + 0.5) * step - 3.0;
    let (mut sum, mut weight) = (0.0, 0.0);
    for j in 0..STEPS {
        for i in 0..STEPS {
            let (x, y) = (place(i), place(j));
            let w = quintic(x) * quintic(y);
            // Fraction of a disk that overlaps the same disk moved by r.
            let r = ((x * x + y * y).sqrt() * cell_mm / aperture_mm).min(1.0);
            sum += w * 2.0 / PI * (acos(r) - r * (1.0 - r * r).sqrt());
            weight += w;
        }
    }
    sum / weight
}

/// The quintic B-spline around 0, which is the autocorrelation of the quadratic one.
fn quintic(x: f64) -> f64 {
    let binomials = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
    let power = |t: f64| if t > 0.0 { t * t * t * t * t } else { 0.0 };
    binomials.iter().enumerate().map(|(k, b)| b * power(3.0 - x.abs() - k as f64)).sum::<f64>() / 120.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spectrum_falls_to_half_where_asked() {
        for half in [20.0, 35.0, 60.0] {
            let clump = clump_mm(half).unwrap();
            assert!((wiener(half * clump) - 0.5).abs() < 1e-9);
            // A Gaussian with the spline's deviation, half a cell, would give 0.1325 / (0.5 cell) or so.
            assert!((half * clump / 0.28 - 1.0).abs() < 0.06, "{}", half * clump);
        }
        for bad in [0.0, -1.0, 1001.0, f64::NAN] {
            assert!(clump_mm(bad).is_err());
        }
    }

    /// Small cells: 1 - (4 / (pi d)) E(r), where r is close to Rayleigh's distribution of the deviation h / sqrt(2) per axis.
    #[test]
    fn little_variance_is_lost_over_large_apertures() {
        let lost = 1.0 - kept_variance(0.001, 0.1);
        let want = 4.0 / PI * (PI / 2.0).sqrt() * 0.5_f64.sqrt() * 0.01;
        assert!((lost / want - 1.0).abs() < 0.02, "{lost} {want}");
    }
}
