//! The refractive index as the tracer evaluates it: once per ray and medium.
//!
//! A Sellmeier formula costs three divisions and a square root. Over a band of light it is, to 1e-10, a quotient of
//! two short polynomials in the wavelength or its square, and then n and 1/n together cost one division.

mod rational;
mod sampled;

pub use rational::Rational;

use rational::Variable;
use sampled::Sampled;
use thiserror::Error;

use crate::medium::Medium;

/// Error of a rational fit, in n, that is small enough to look no further.
const RATIONAL_TOLERANCE: f64 = 2e-10;
/// Largest error of any fit, in n.
const LAST_TOLERANCE: f64 = 1e-9;
/// Variables and nodes that are tried, in this order, at each degree. Glass formulas are functions of the squared wavelength.
const TRIALS: [(Variable, Variable); 3] = [
    (Variable::Square, Variable::InverseSquare),
    (Variable::Square, Variable::Wavelength),
    (Variable::Wavelength, Variable::Wavelength),
];
/// An interpolation this many times worse than required may still be leveled into the tolerance.
const HOPE: f64 = 50.0;
/// Number of wavelengths at which a fit is checked.
const CHECKS: usize = 4000;

/// Reason why no dispersion can be fitted to a medium.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum DispersionError {
    /// The band is empty, reversed or not positive.
    #[error("not a band of wavelengths: {min_nm} to {max_nm} nm")]
    Band {
        /// Shortest wavelength, nm.
        min_nm: f64,
        /// Longest wavelength, nm.
        max_nm: f64,
    },
    /// The formula has no positive real index at some wavelength of the band.
    #[error("no refractive index at {wavelength_nm} nm")]
    NoIndex {
        /// Wavelength without an index, nm.
        wavelength_nm: f64,
    },
}

#[derive(Clone, Debug)]
enum FittedForm {
    Rational(Rational),
    Sampled(Sampled),
    /// The medium itself, if its data are too rough for either.
    Exact(Medium),
}

/// A fast and nearly exact approximation of n(lambda) and 1/n over a band of light.
#[derive(Clone, Debug)]
pub struct Dispersion {
    form: FittedForm,
    band_nm: (f64, f64),
    max_error: f64,
}

impl Dispersion {
    /// Fits `medium` from `min_nm` to `max_nm`. The result is the rational function of the smallest degree up to (6, 6) that is
    /// within 2e-10 of the formula, or else the most accurate one within 1e-9. Tabulated data become a uniform table of cubics
    /// within 1e-9. If data are too rough for that, the formula itself is kept.
    ///
    /// Where the band reaches beyond the medium's data ([`Medium::covers`]) its formula is extrapolated.
    ///
    /// # Errors
    /// An invalid band, or a formula without a positive index somewhere in it.
    pub fn fit(medium: &Medium, min_nm: f64, max_nm: f64) -> Result<Dispersion, DispersionError> {
        if !(min_nm > 0.0 && min_nm < max_nm && max_nm.is_finite()) {
            return Err(DispersionError::Band { min_nm, max_nm });
        }
        // One wavelength is enough for a medium without dispersion.
        let count = if matches!(medium, Medium::Constant(_) | Medium::Air) { 1 } else { CHECKS };
        let checks: Vec<(f64, f64)> = (0..count)
            .map(|i| min_nm + (max_nm - min_nm) * i as f64 / (CHECKS - 1) as f64)
            .map(|w| (w, medium.index(w)))
            .collect();
        if let Some(&(wavelength_nm, _)) = checks.iter().find(|(_, n)| !(n.is_finite() && *n > 0.0)) {
            return Err(DispersionError::NoIndex { wavelength_nm });
        }
        let band_nm = (min_nm, max_nm);
        let mut best: Option<(Rational, f64)> = None;
        for degree in 0..=Rational::MAX_DEGREE {
            for (variable, nodes) in TRIALS {
                let Some(mut rational) = Rational::fit(medium, min_nm, max_nm, degree, variable, nodes) else {
                    continue;
                };
                let mut max_error = largest_error(&checks, |w| rational.evaluate(w));
                if max_error > RATIONAL_TOLERANCE && max_error < HOPE * RATIONAL_TOLERANCE {
                    (rational, max_error) = rational.level(&checks);
                }
                if max_error <= RATIONAL_TOLERANCE {
                    return Ok(Dispersion { form: FittedForm::Rational(rational), band_nm, max_error });
                }
                if max_error <= LAST_TOLERANCE && best.as_ref().is_none_or(|(_, error)| max_error < *error) {
                    best = Some((rational, max_error));
                }
            }
        }
        if let Some((rational, max_error)) = best {
            return Ok(Dispersion { form: FittedForm::Rational(rational), band_nm, max_error });
        }
        if let Some((sampled, max_error)) = Sampled::fit(medium, min_nm, max_nm, LAST_TOLERANCE, &checks) {
            return Ok(Dispersion { form: FittedForm::Sampled(sampled), band_nm, max_error });
        }
        Ok(Dispersion { form: FittedForm::Exact(medium.clone()), band_nm, max_error: 0.0 })
    }

    /// Largest difference from the medium's formula that was found at 4 000 wavelengths of the band.
    #[must_use]
    pub fn max_error(&self) -> f64 {
        self.max_error
    }

    /// Band of the fit: shortest and longest wavelength, nm.
    #[must_use]
    pub fn band_nm(&self) -> (f64, f64) {
        self.band_nm
    }

    /// Returns the rational function, for kernels that evaluate it themselves; `None` if the fit has another form.
    #[must_use]
    pub fn rational(&self) -> Option<&Rational> {
        match &self.form {
            FittedForm::Rational(rational) => Some(rational),
            FittedForm::Sampled(_) | FittedForm::Exact(_) => None,
        }
    }

    /// Returns the index if it is the same at all wavelengths; otherwise `None`.
    #[must_use]
    pub fn constant(&self) -> Option<f64> {
        self.rational().filter(|r| r.degree() == 0).map(|r| r.evaluate(self.band_nm.0))
    }

    /// Refractive index at a wavelength in nm. Meant for the band; not accurate outside of it.
    #[inline]
    #[must_use]
    pub fn evaluate(&self, wavelength_nm: f64) -> f64 {
        match &self.form {
            FittedForm::Rational(rational) => rational.evaluate(wavelength_nm),
            FittedForm::Sampled(sampled) => sampled.evaluate(wavelength_nm),
            FittedForm::Exact(medium) => medium.index(wavelength_nm),
        }
    }

    /// Computes n and 1/n for each wavelength (nm) of a batch. n has the same bits as from [`Dispersion::evaluate`], whatever the
    /// length of the slices. All forms except the rational one are evaluated wavelength by wavelength.
    ///
    /// # Panics
    /// If the slices differ in length.
    #[inline(always)]
    pub fn index_and_inverse(&self, wavelength_nm: &[f64], n: &mut [f64], inverse_n: &mut [f64]) {
        assert!(wavelength_nm.len() == n.len() && n.len() == inverse_n.len(), "columns of a batch have one length");
        match &self.form {
            FittedForm::Rational(rational) => rational.index_and_inverse(wavelength_nm, n, inverse_n),
            FittedForm::Sampled(sampled) => {
                for ((w, n), inverse) in wavelength_nm.iter().zip(n).zip(inverse_n) {
                    *n = sampled.evaluate(*w);
                    *inverse = 1.0 / *n;
                }
            }
            FittedForm::Exact(medium) => {
                for ((w, n), inverse) in wavelength_nm.iter().zip(n).zip(inverse_n) {
                    *n = medium.index(*w);
                    *inverse = 1.0 / *n;
                }
            }
        }
    }
}

fn largest_error(checks: &[(f64, f64)], n: impl Fn(f64) -> f64) -> f64 {
    // An error that is not a number must not pass as small.
    checks.iter().map(|&(w, exact)| (n(w) - exact).abs()).fold(0.0, |m, e| if e > m || e.is_nan() { e } else { m })
}

#[cfg(test)]
mod tests;
