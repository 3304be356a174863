//! The strategy `uniform`: a constant density over the band; if the source also has lines, they get half of the samples.

use crate::{Mixture, Quantiles, Shares};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Fault, Faults, Params};
use spectra_core::registry::Context;

use spectra_core::spectral::SystemResponse;
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};

/// The strategy `uniform`: draws every wavelength of the band alike.
#[derive(Clone, Copy, Debug, Default)]
pub struct Uniform;

impl WavelengthSampler for Uniform {
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, Fault> {
        let has_continuum = system.source.continuum.iter().any(|v| *v != 0.0);
        let continuum = (has_continuum || system.source.lines.is_empty())
            .then(|| Quantiles::of(system.grid, &vec![1.0; system.grid.count]))
            .flatten();
        let weights = vec![1.0; system.source.lines.len()];
        Mixture::new(&system.source.lines, &weights, Shares::WholeStrata, 0.5, continuum)
            .map(|m| Box::new(m) as Box<dyn WavelengthDensity>)
            .ok_or_else(|| Fault::new("the source emits nothing"))
    }
}

/// Every wavelength of the band is drawn alike.
///
/// It is a reference for the other strategies, and the choice if you want the spectrum itself at every wavelength. If the
/// source has both lines and a continuum, the lines get half of the samples; if it has only lines, they get all.
///
/// # Example
/// ```yaml
/// {kind: uniform}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct UniformParams {}

spectra_core::register!(wavelengths "uniform": UniformParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn WavelengthSampler>, Faults> {
    let UniformParams {} = params.parse()?;
    Ok(Box::new(Uniform))
}
