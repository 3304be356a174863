//! Built-in ways to draw a wavelength.
//!
//! All strategies share one form ([`mixture::Mixture`]): lines are drawn as lines, the continuum by
//! inverting a table of quantiles. They differ in the density that they build it from.

mod lines;
mod mixture;
mod quantiles;
mod source_times_response;
mod uniform;

pub use mixture::Mixture;
pub use quantiles::Quantiles;

use serde::Deserialize;
use spectra_core::params::{Faults, Params};

/// Parameters of strategies that have none.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct NoParams {}

fn no_params(params: &Params) -> Result<(), Faults> {
    params.parse::<NoParams>().map(|_| ())
}
