//! The strategy `inverse-transform`: the density is any named spectrum, drawn by inverting its integral.
//!
//! A fraction of the samples (see [`Floor`]) follows the response of the channels, so that a spectrum that is zero where a channel
//! is sensitive causes no bias. Without a floor, such a spectrum is refused.

use crate::recorded_spectrum::RecordedSpectrum;
use crate::{Floor, Quantiles};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Fault, Faults, Params};
use spectra_core::registry::Context;
use spectra_core::spectral::{Grid, SystemResponse};
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};
use spectra_spectrum::{AnySpectrum, Observer, find_in};

/// Wavelengths are drawn in proportion to any named spectrum.
///
/// The density is the spectrum divided by its integral, and is drawn by inverting that integral. Many renderers use a
/// density shaped like human vision (`y-bar`). On film it is a poor choice, since film is sensitive below 400 nm, where
/// y-bar is close to zero. `floor` keeps a spectrum that is zero where a channel is sensitive from causing bias; with
/// `floor: 0` such a spectrum is refused.
///
/// # Example
/// ```yaml
/// {kind: inverse-transform, spectrum: y-bar}
/// ```
/// ```yaml
/// {kind: inverse-transform, spectrum: "gaussian:550,50", floor: 10 %}
/// ```
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct InverseTransformParams {
    /// Spectrum to draw in proportion to: `x-bar`, `y-bar` or `z-bar` (CIE 1931, 2 degrees), a bundled spectrum such as
    /// `D65`, a file beside the scene, or an inline one such as `gaussian:550,50`. It needs a continuum.
    pub spectrum: String,
    /// Fraction of the samples that follow the summed response of all channels instead, 0 to below 1, so that every wavelength to which
    /// a channel is sensitive can be drawn; 1/16 if left out.
    #[serde(default)]
    pub floor: Floor,
}

/// The strategy `inverse-transform`: draws wavelengths in proportion to a spectrum.
#[derive(Clone, Debug)]
pub struct InverseTransform {
    name: String,
    grid: Grid,
    /// Values of the spectrum on `grid`, in any scale.
    spectrum: Vec<f64>,
    floor: Floor,
}

impl InverseTransform {
    /// Creates the strategy for `spectrum`, given on `grid` in any scale and called `name` in messages. `None` unless it has one value
    /// per point of the grid, all finite and not negative, and at least one positive.
    #[must_use]
    pub fn new(name: &str, grid: Grid, spectrum: Vec<f64>, floor: Floor) -> Option<Self> {
        let sound = spectrum.len() == grid.count
            && spectrum.iter().all(|v| v.is_finite() && *v >= 0.0)
            && spectrum.iter().any(|v| *v > 0.0);
        sound.then(|| Self { name: name.to_owned(), grid, spectrum, floor })
    }
}

impl WavelengthSampler for InverseTransform {
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, Fault> {
        let seen = RecordedSpectrum::of(system)?;
        let grid = system.grid;
        let resampled = (grid != self.grid)
            .then(|| grid.wavelengths_nm().map(|w| self.grid.interpolate(&self.spectrum, w)).collect::<Vec<_>>());
        let spectrum = resampled.as_ref().unwrap_or(&self.spectrum);
        if self.floor == Floor::NONE {
            let blind = |i: &usize| {
                let either = |of: &[f64]| of[*i] > 0.0 || of[*i + 1] > 0.0;
                either(&seen.response) && !either(spectrum)
            };
            if let Some(i) = (0..grid.count - 1).find(blind) {
                return Err(Fault::new(format!(
                    "`{}` is zero at {} nm, where a channel is sensitive: that light would never be sampled",
                    self.name,
                    grid.wavelength_nm(i)
                ))
                .hint("add a `floor`"));
            }
        }
        let shape = seen.with_floor(spectrum, grid.integrate(spectrum), self.floor.share());
        let continuum = seen.draws_continuum().then(|| Quantiles::of(grid, &shape)).flatten();
        Ok(Box::new(seen.mixture(system, continuum)?))
    }
}

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn WavelengthSampler>, Faults> {
    let InverseTransformParams { spectrum: name, floor } = params.parse()?;
    let grid = context.grid;
    let fault = |text: String| params.fault("spectrum", text);
    let spectrum = match ["x-bar", "y-bar", "z-bar"].iter().position(|n| *n == name.trim().to_ascii_lowercase()) {
        Some(i) => Observer::cie_1931_2deg().on_grid(&grid)[i].clone(),
        None => match find_in(&name, context.resources).map_err(|e| e.faults(fault))? {
            AnySpectrum::Emission(light) if light.continuum().is_none() => {
                let text = format!("`{name}` has lines only, and so no density over wavelengths");
                return Err(fault(text).hint("write `kind: lines`, which draws the source's lines").into());
            }
            AnySpectrum::Emission(light) => light.on_grid(&grid),
            AnySpectrum::Transmittance(filter) => filter.on_grid(&grid),
            AnySpectrum::Reflectance(surface) => surface.on_grid(&grid),
            AnySpectrum::Sensitivity(detector) => detector.on_grid(&grid),
        },
    };
    let sampler = InverseTransform::new(&name, grid, spectrum, floor)
        .ok_or_else(|| fault(format!("`{name}` is zero in the whole band")))?;
    Ok(Box::new(sampler))
}

spectra_core::register!(wavelengths "inverse-transform": InverseTransformParams, build);
