//! Dispersion formulas from measured points.
//!
//! ```
//! use spectra_glass::fit::{Sample, cauchy_least_squares};
//!
//! let crown = [(486.0, 1.523), (589.0, 1.517), (656.0, 1.514)].map(|(wavelength_nm, n)| Sample { wavelength_nm, n });
//! let fit = cauchy_least_squares(&crown, 2)?;
//! assert!(fit.max_deviation < 5e-4);
//! # Ok::<(), spectra_glass::fit::FitError>(())
//! ```

mod cauchy;
mod linear_forms;
pub(crate) mod samples;
mod sellmeier;

pub use cauchy::{CauchyRows, cauchy_by_rows, cauchy_least_squares};
pub use linear_forms::{conrady_least_squares, herzberger_least_squares, schott_least_squares};
pub use samples::{NamedSamples, SamplesError, read_csv};
pub use sellmeier::sellmeier_least_squares;

use thiserror::Error;

use crate::formula::Formula;

/// A refractive index measured at a wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Wavelength in air, nm.
    pub wavelength_nm: f64,
    /// Refractive index.
    pub n: f64,
}

/// A fitted formula, and how far it deviates from the samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The formula.
    pub formula: Formula,
    /// Root mean square of the differences in index.
    pub rms_deviation: f64,
    /// Mean of the absolute differences in index.
    pub mean_deviation: f64,
    /// Largest absolute difference in index.
    pub max_deviation: f64,
}

impl Fit {
    fn of(formula: Formula, samples: &[Sample]) -> Fit {
        let deviations: Vec<f64> = samples.iter().map(|s| (formula.index(s.wavelength_nm) - s.n).abs()).collect();
        let count = deviations.len() as f64;
        Fit {
            rms_deviation: (deviations.iter().map(|d| d * d).sum::<f64>() / count).sqrt(),
            mean_deviation: deviations.iter().sum::<f64>() / count,
            max_deviation: deviations.iter().copied().fold(0.0, f64::max),
            formula,
        }
    }
}

/// Reason why no formula can be fitted to samples.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum FitError {
    /// Too few samples for the number of coefficients.
    #[error("{found} samples are too few: {needed} are needed")]
    TooFew {
        /// Number of samples that are needed.
        needed: usize,
        /// Number of samples that were given.
        found: usize,
    },
    /// A wavelength or index that is not valid.
    #[error("row {row}: the wavelength must be positive and the index at least 1")]
    BadSample {
        /// Row of the sample, from 1.
        row: usize,
    },
    /// Two samples have the same wavelength, or the number of terms is not supported.
    #[error("the samples do not determine the coefficients")]
    Undetermined,
}

fn check(samples: &[Sample], needed: usize) -> Result<(), FitError> {
    let bad = |s: &Sample| !(s.wavelength_nm.is_finite() && s.wavelength_nm > 0.0 && s.n.is_finite() && s.n >= 1.0);
    if let Some(row) = samples.iter().position(bad) {
        return Err(FitError::BadSample { row: row + 1 });
    }
    if samples.len() < needed {
        return Err(FitError::TooFew { needed, found: samples.len() });
    }
    Ok(())
}
