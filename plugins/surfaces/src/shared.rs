//! Code that several kinds of surface share: checks of parameters, and the formulas of conics.

use spectra_core::params::{Faults, LengthOrInfinity, Params};

/// Largest number of coefficients of an asphere.
pub(crate) const MOST_COEFFICIENTS: usize = 20;

/// Returns the curvature, 1/mm, for the radius under `key`. Adds a fault if the radius is 0.
pub(crate) fn curvature(params: &Params, key: &str, radius: LengthOrInfinity, faults: &mut Faults) -> f64 {
    if radius.mm() == 0.0 {
        faults.push(
            params
                .fault(key, "a surface cannot have a radius of 0")
                .hint(format!("for no curvature write `{key}: inf`")),
        );
    }
    1.0 / radius.mm()
}

/// A conic of revolution, with the sag z = c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ConicSection {
    /// Curvature c at the vertex, 1/mm.
    pub curvature_per_mm: f64,
    /// 1 + k, where k is the conic constant.
    pub one_plus_conic: f64,
}

impl ConicSection {
    pub(crate) fn new(curvature_per_mm: f64, conic: f64) -> Self {
        Self { curvature_per_mm, one_plus_conic: 1.0 + conic }
    }

    /// Returns this section with all lengths multiplied by `factor`.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self { curvature_per_mm: self.curvature_per_mm / factor, ..self }
    }

    /// Returns the sag (mm) and its derivative with respect to r^2 (1/mm). `radius2` is r^2 (mm^2). `None` beyond the rim.
    pub(crate) fn sag_and_slope(&self, radius2: f64) -> Option<(f64, f64)> {
        let c = self.curvature_per_mm;
        if c == 0.0 {
            return Some((0.0, 0.0));
        }
        let square = 1.0 - self.one_plus_conic * c * c * radius2;
        if !(square >= 0.0) {
            return None;
        }
        let root = square.sqrt();
        Some((c * radius2 / (1.0 + root), c / (2.0 * root)))
    }

    /// Returns the sag (mm) at the squared radius `radius2` (mm^2). `None` beyond the rim.
    pub(crate) fn sag_mm(&self, radius2: f64) -> Option<f64> {
        self.sag_and_slope(radius2).map(|(sag, _)| sag)
    }
}

/// Scales the coefficients of r^first, r^(first + step), ..., in mm^(1 - power), so that all lengths become `factor` times as long.
pub(crate) fn scaled_powers(coefficients: &[f64], first: i32, step: i32, factor: f64) -> Vec<f64> {
    let scaled = |(i, a): (usize, &f64)| {
        let power = 1 - first - step * i as i32;
        let each = if power < 0 { 1.0 / factor } else { factor };
        (0..power.unsigned_abs()).fold(*a, |value, _| value * each)
    };
    coefficients.iter().enumerate().map(scaled).collect()
}

/// Evaluates the polynomial with terms a_i x^i, from i = 0, and its derivative, by Horner's rule.
#[inline(always)]
pub(crate) fn polynomial(coefficients: &[f64], x: f64) -> (f64, f64) {
    let (mut value, mut slope) = (0.0, 0.0);
    for a in coefficients.iter().rev() {
        slope = slope * x + value;
        value = value * x + a;
    }
    (value, slope)
}
