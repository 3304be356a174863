//! `kind: source-times-response`: the source's power times what the imager can see (the default).
//!
//! A density that is zero where any channel sees is a bias, so the product is mixed with 5 % of the
//! summed response of all channels. (A uniform floor over the band would cost ten times as much:
//! its strata straddle the edges of what a film sees.)
//!
//! Lines beside no continuum, or no more channels than one, come out exact; see [`crate::Shares`].

use crate::seen::Seen;
use crate::{Mixture, Quantiles};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;

use spectra_core::spectral::SystemResponse;
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};

/// Share of the samples that follow the summed response alone.
const FLOOR: f64 = 0.05;

/// The strategy.
#[derive(Clone, Copy, Debug, Default)]
pub struct SourceTimesResponse;

impl SourceTimesResponse {
    pub(crate) fn density(system: &SystemResponse) -> Result<Mixture, String> {
        let seen = Seen::of(system)?;
        let continuum = seen
            .draws_continuum()
            .then(|| Quantiles::of(system.grid, &seen.with_floor(&seen.product, seen.of_continuum, FLOOR)))
            .flatten();
        seen.mixture(system, continuum)
    }
}

impl WavelengthSampler for SourceTimesResponse {
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, String> {
        Ok(Box::new(Self::density(system)?))
    }
}

/// The source's power times what the imager sees; lines as lines.
///
/// The strategy that is taken where a scene names none, and the one to render with: wavelengths are drawn where their
/// light matters, so the noise that they add is small whatever the film. Spectral lines are drawn as lines, each at its
/// own wavelength and in proportion to what is seen of it.
///
/// Of the samples 5 % follow the summed response of all channels alone, so that the density is nowhere zero where a
/// channel sees: that would be a bias.
///
/// # Example
/// ```yaml
/// {kind: source-times-response}
/// ```
/// ```yaml
/// {band: [380 nm, 780 nm]}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct SourceTimesResponseParams {}

spectra_core::register!(wavelengths "source-times-response" (default): SourceTimesResponseParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn WavelengthSampler>, Faults> {
    let SourceTimesResponseParams {} = params.parse()?;
    Ok(Box::new(SourceTimesResponse))
}
