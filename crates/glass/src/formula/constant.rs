//! An index without dispersion.

use super::{Formula, FormulaEntry};
use schemars::JsonSchema;
use serde::Deserialize;

/// A constant index, the same at every wavelength.
///
/// No real glass is like this. Use it for lenses of textbooks, or to see what dispersion alone does to a picture.
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
