//! The strategy `source-times-response`: the density is the source's power times the imager's response (the default).
//!
//! A density that is zero where a channel is sensitive causes bias, so the product is mixed with 5 % of the summed response of all
//! channels. (A uniform floor over the band would cost ten times as much, because its strata straddle the ends of a film's
//! sensitivity.)
//!
//! A source of lines only comes out exact: with one channel in every sample, with several in 64 stratified ones; see
//! [`crate::Shares`].

use crate::recorded_spectrum::RecordedSpectrum;
use crate::{Mixture, Quantiles};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Fault, Faults, Params};
use spectra_core::registry::Context;

use spectra_core::spectral::SystemResponse;
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};

/// Fraction of the samples that follow the summed response alone.
const FLOOR: f64 = 0.05;

/// The strategy `source-times-response`: draws wavelengths by the source's power times the imager's response.
#[derive(Clone, Copy, Debug, Default)]
pub struct SourceTimesResponse;

impl SourceTimesResponse {
    pub(crate) fn density(system: &SystemResponse) -> Result<Mixture, Fault> {
        let seen = RecordedSpectrum::of(system)?;
        let continuum = seen
            .draws_continuum()
            .then(|| Quantiles::of(system.grid, &seen.with_floor(&seen.product, seen.of_continuum, FLOOR)))
            .flatten();
        seen.mixture(system, continuum)
    }
}

impl WavelengthSampler for SourceTimesResponse {
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, Fault> {
        Ok(Box::new(Self::density(system)?))
    }
}

/// Wavelengths are drawn by the source's power times the imager's response.
///
/// This is the default, and the strategy to render with. Wavelengths are drawn where their light matters, so the noise
/// that they add is small whatever the film. Spectral lines are drawn as lines, each at its own wavelength and in
/// proportion to its power times the response to it.
///
/// 5 % of the samples follow the summed response of all channels alone, so that the density is nowhere zero where a
/// channel is sensitive. A zero there would cause bias.
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
