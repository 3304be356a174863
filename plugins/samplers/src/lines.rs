//! The strategy `lines`: draws only the source's spectral lines, in proportion to their power.

use crate::{Mixture, Quantiles, Shares};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Fault, Faults, Params};
use spectra_core::registry::Context;

use spectra_core::spectral::SystemResponse;
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};

/// The strategy `lines`: draws the source's spectral lines in proportion to their power.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lines;

impl WavelengthSampler for Lines {
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, Fault> {
        if system.source.continuum.iter().any(|v| *v != 0.0) {
            return Err(Fault::new("the source has a continuum, which sampling only lines would miss").hint(
                "use `source-times-response`, or a source whose color model has only lines, such as `fraunhofer`",
            ));
        }
        let weights: Vec<f64> = system.source.lines.iter().map(|l| l.power.abs()).collect();
        Mixture::<Quantiles>::new(&system.source.lines, &weights, Shares::Proportional, 1.0, None)
            .map(|m| Box::new(m) as Box<dyn WavelengthDensity>)
            .ok_or_else(|| Fault::new("the source has no spectral lines"))
    }
}

/// Only the source's spectral lines are drawn, in proportion to their power.
///
/// Use it for gas lamps, and for pictures whose color model consists of lines (`color: {kind: fraunhofer}`). Each line is
/// drawn in proportion to its power, whatever the imager's response to it. A source with a continuum is refused, since
/// drawing only lines would miss it.
///
/// # Example
/// ```yaml
/// {kind: lines}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct LinesParams {}

spectra_core::register!(wavelengths "lines": LinesParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn WavelengthSampler>, Faults> {
    let LinesParams {} = params.parse()?;
    Ok(Box::new(Lines))
}
