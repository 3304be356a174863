//! Formulas that are linear in their coefficients, by least squares: Conrady, Schott, Herzberger.

use super::{Fit, FitError, Sample, check};
use crate::formula::{CONRADY, HERZBERGER, SCHOTT};
use spectra_numerics::linear;

/// Fits Conrady's n = c0 + c1 / L + c2 / L^3.5 by least squares; needs three samples or more.
///
/// # Errors
/// Too few samples, an invalid wavelength or index, coefficients that are not determined.
pub fn conrady_least_squares(samples: &[Sample]) -> Result<Fit, FitError> {
    let basis = |um: f64| [1.0, 1.0 / um, 1.0 / (um * um * um * um.sqrt())];
    let c = solve(samples, basis, |n| (n, 1.0))?;
    Ok(Fit::of(CONRADY.with(&c), samples))
}

/// Fits Schott's n^2 = c0 + c1 L^2 + c2 L^-2 + c3 L^-4 + c4 L^-6 + c5 L^-8 by least squares; needs six samples or more. The
/// squared index is fitted with the weight 1 / (2 n), so that the deviations of n are weighted equally.
///
/// # Errors
/// As [`conrady_least_squares`].
pub fn schott_least_squares(samples: &[Sample]) -> Result<Fit, FitError> {
    let basis = |um: f64| {
        let x = 1.0 / (um * um);
        [1.0, um * um, x, x * x, x * x * x, x * x * x * x]
    };
    let c = solve(samples, basis, |n| (n * n, 0.5 / n))?;
    Ok(Fit::of(SCHOTT.with(&c), samples))
}

/// Fits Herzberger's n = A + B l + C l^2 + D L^2 + E L^4 + F L^6 with l = 1 / (L^2 - 0.028) by least squares; needs six samples
/// or more, none near the pole at 167 nm.
///
/// # Errors
/// As [`conrady_least_squares`].
pub fn herzberger_least_squares(samples: &[Sample]) -> Result<Fit, FitError> {
    let basis = |um: f64| {
        let square = um * um;
        let l = 1.0 / (square - 0.028);
        [1.0, l, l * l, square, square * square, square * square * square]
    };
    let c = solve(samples, basis, |n| (n, 1.0))?;
    Ok(Fit::of(HERZBERGER.with(&c), samples))
}

/// Fits the coefficients of a basis (of the wavelength, um). `value` turns an index into the fitted quantity and its weight.
fn solve<const N: usize>(
    samples: &[Sample],
    basis: impl Fn(f64) -> [f64; N],
    value: impl Fn(f64) -> (f64, f64),
) -> Result<[f64; N], FitError> {
    check(samples, N)?;
    let rows: Vec<[f64; N]> = samples.iter().map(|s| basis(s.wavelength_nm * 1e-3)).collect();
    // Scales columns to one size: powers of the wavelength differ by orders of magnitude.
    let scale: [f64; N] = std::array::from_fn(|k| rows.iter().map(|r| r[k].abs()).fold(0.0, f64::max));
    if !scale.iter().all(|s| s.is_finite() && *s > 0.0) {
        return Err(FitError::Undetermined);
    }
    let mut matrix = Vec::with_capacity(samples.len() * N);
    let mut right = Vec::with_capacity(samples.len());
    for (row, sample) in rows.iter().zip(samples) {
        let (target, weight) = value(sample.n);
        matrix.extend((0..N).map(|k| weight * row[k] / scale[k]));
        right.push(weight * target);
    }
    let solution = linear::least_squares(&matrix, &right, N).ok_or(FitError::Undetermined)?;
    Ok(std::array::from_fn(|k| solution[k] / scale[k]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::Formula;
    use crate::formula::SELLMEIER_1;

    fn samples(made: &Formula) -> Vec<Sample> {
        let wavelengths = [334.1, 365.0, 404.7, 435.8, 486.1, 546.1, 587.6, 656.3, 706.5, 852.1, 1014.0];
        wavelengths.map(|wavelength_nm| Sample { wavelength_nm, n: made.index(wavelength_nm) }).into()
    }

    /// Schott BASF5 by Conrady's form and HOYA BAF9 by Schott's, as their makers give them: the coefficients come back.
    #[test]
    fn makers_coefficients_come_back() {
        let conrady = [1.574_103_27, 0.013_978_614_9, 8.300_451_1e-4];
        let fit = conrady_least_squares(&samples(&CONRADY.with(&conrady))).expect("determined");
        for (got, made) in fit.formula.coefficients().iter().zip(conrady) {
            assert!((got - made).abs() < 1e-12, "{got} {made}");
        }
        let schott = [2.645_77, -0.010_100_029, 0.018_254_281, 7.007_040_1e-4, -3.697_830_4e-5, 3.153_272_2e-6];
        let fit = schott_least_squares(&samples(&SCHOTT.with(&schott))).expect("determined");
        assert!(fit.max_deviation < 1e-13, "{}", fit.max_deviation);
        for (got, made) in fit.formula.coefficients().iter().zip(schott) {
            assert!((got - made).abs() < 1e-8, "{got} {made}");
        }
        let herzberger = [2.268_8, 0.03, 0.001, -0.001, 2e-5, -3e-7];
        let fit = herzberger_least_squares(&samples(&HERZBERGER.with(&herzberger))).expect("determined");
        assert!(fit.max_deviation < 1e-12, "{}", fit.max_deviation);
    }

    /// A glass of another form (N-BK7 by Sellmeier): the largest deviations that numpy 2's least squares leaves.
    #[test]
    fn other_forms_are_met_as_well_as_they_can_be() {
        let n_bk7 = [1.039_612_12, 0.006_000_698_67, 0.231_792_344, 0.020_017_914_4, 1.010_469_45, 103.560_653];
        let samples = samples(&SELLMEIER_1.with(&n_bk7));
        for (fit, deviation) in [
            (schott_least_squares(&samples), 2.4816e-7),
            (herzberger_least_squares(&samples), 5.0498e-6),
            (conrady_least_squares(&samples[2..9]), 4.4268e-6),
        ] {
            let got = fit.expect("determined").max_deviation;
            assert!((got / deviation - 1.0).abs() < 1e-3, "{got} {deviation}");
        }
    }

    #[test]
    fn refuses_what_determines_nothing() {
        let same = [Sample { wavelength_nm: 500.0, n: 1.5 }; 8];
        assert_eq!(conrady_least_squares(&same), Err(FitError::Undetermined));
        assert_eq!(schott_least_squares(&same[..5]), Err(FitError::TooFew { needed: 6, found: 5 }));
        assert_eq!(herzberger_least_squares(&same), Err(FitError::Undetermined));
    }
}
