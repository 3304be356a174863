//! Cauchy's formula from a table.

use super::{Fit, FitError, Sample, check};
use crate::formula::CAUCHY;
use spectra_numerics::linear;

/// Coefficients A and B of Cauchy's formula for each pair of neighboring rows, and their means.
#[derive(Clone, Debug, PartialEq)]
pub struct CauchyRows {
    /// Mean of A over the rows.
    pub a: f64,
    /// Mean of B over the rows, nm^2.
    pub b_nm2: f64,
    /// A for each row i: A_i = n_i - B / lambda_i^2, with the mean B.
    pub a_rows: Vec<f64>,
    /// B for each row i, nm^2, from rows i and i + 1; the last from the last row and the first.
    pub b_rows_nm2: Vec<f64>,
    /// Formula with the mean A and B, and its deviation from the rows.
    pub fit: Fit,
}

/// Fits Cauchy's n = A + B / lambda^2 from neighboring rows and their means, as in laboratory courses.
///
/// # Errors
/// Fewer than two rows, a row with an invalid wavelength or index, two neighbors at one wavelength.
pub fn cauchy_by_rows(samples: &[Sample]) -> Result<CauchyRows, FitError> {
    check(samples, 2)?;
    let count = samples.len();
    let x = |i: usize| 1.0 / (samples[i].wavelength_nm * samples[i].wavelength_nm);
    let mut b_rows_nm2 = Vec::with_capacity(count);
    for i in 0..count {
        let j = (i + 1) % count;
        let b = (samples[i].n - samples[j].n) / (x(i) - x(j));
        if !b.is_finite() {
            return Err(FitError::Undetermined);
        }
        b_rows_nm2.push(b);
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let b_nm2 = mean(&b_rows_nm2);
    let a_rows: Vec<f64> = (0..count).map(|i| samples[i].n - b_nm2 * x(i)).collect();
    let a = mean(&a_rows);
    let fit = Fit::of(CAUCHY.with(&[a, b_nm2 * 1e-6]), samples);
    Ok(CauchyRows { a, b_nm2, a_rows, b_rows_nm2, fit })
}

/// Fits Cauchy's formula with `terms` coefficients (1 to 6) by least squares: n = A + B L^-2 + C L^-4 + ...
///
/// # Errors
/// Fewer samples than terms, an invalid wavelength or index, terms out of range or not determined.
pub fn cauchy_least_squares(samples: &[Sample], terms: usize) -> Result<Fit, FitError> {
    check(samples, terms)?;
    if !(1..=6).contains(&terms) {
        return Err(FitError::Undetermined);
    }
    // Powers are relative to the largest 1 / lambda^2, so that columns are alike in size.
    let inverse = |s: &Sample| 1e6 / (s.wavelength_nm * s.wavelength_nm);
    let largest = samples.iter().map(inverse).fold(0.0, f64::max);
    let mut matrix = Vec::with_capacity(samples.len() * terms);
    for sample in samples {
        let x = inverse(sample) / largest;
        let mut power = 1.0;
        for _ in 0..terms {
            matrix.push(power);
            power *= x;
        }
    }
    let right: Vec<f64> = samples.iter().map(|s| s.n).collect();
    let mut c = linear::least_squares(&matrix, &right, terms).ok_or(FitError::Undetermined)?;
    let mut scale = 1.0;
    for c in &mut c {
        *c /= scale;
        scale *= largest;
    }
    Ok(Fit::of(CAUCHY.with(&c), samples))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(rows: &[(f64, f64)]) -> Vec<Sample> {
        rows.iter().map(|&(wavelength_nm, n)| Sample { wavelength_nm, n }).collect()
    }

    #[test]
    fn finds_the_coefficients_that_made_the_samples() {
        let made = CAUCHY.with(&[1.5, 0.004, 1e-4, -2e-6]);
        let rows: Vec<_> = [365.0, 405.0, 436.0, 486.0, 546.0, 588.0, 656.0, 852.0].map(|w| (w, made.index(w))).into();
        let fit = cauchy_least_squares(&samples(&rows), 4).expect("determined");
        for (got, expected) in fit.formula.coefficients().iter().zip([1.5, 0.004, 1e-4, -2e-6]) {
            assert!((got - expected).abs() < 1e-10, "{got} {expected}");
        }
        assert!(fit.max_deviation < 1e-14);
        let two = cauchy_by_rows(&samples(&[(400.0, 1.5 + 5000.0 / 160_000.0), (500.0, 1.5 + 5000.0 / 250_000.0)]))
            .expect("determined");
        assert!((two.a - 1.5).abs() < 1e-13 && (two.b_nm2 - 5000.0).abs() < 1e-7);
    }

    #[test]
    fn refuses_what_determines_nothing() {
        assert_eq!(cauchy_by_rows(&samples(&[(500.0, 1.5)])), Err(FitError::TooFew { needed: 2, found: 1 }));
        assert_eq!(cauchy_by_rows(&samples(&[(500.0, 1.5), (500.0, 1.6)])), Err(FitError::Undetermined));
        assert_eq!(cauchy_least_squares(&samples(&[(500.0, 1.5), (500.0, 1.6)]), 2), Err(FitError::Undetermined));
        assert_eq!(
            cauchy_least_squares(&samples(&[(500.0, 1.5), (-1.0, 1.6)]), 2),
            Err(FitError::BadSample { row: 2 })
        );
        assert_eq!(cauchy_least_squares(&samples(&[(500.0, 1.5)]), 0), Err(FitError::Undetermined));
    }
}
