//! An index without dispersion.

use super::{Formula, FormulaEntry};
use schemars::JsonSchema;
use serde::Deserialize;

/// The same index at every wavelength.
///
/// No glass is so; for lenses of textbooks, and to see what dispersion alone does to a picture.
///
/// # Example
/// ```yaml
/// {formula: constant, coefficients: [1.5168]}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Params {
    /// The index.
    coefficients: [f64; 1],
}

spectra_core::register!(FormulaEntry, "constant": Params, |params, _| {
    params.parse().map(|Params { coefficients: [n] }| Box::new(Formula::Constant(n)))
});
