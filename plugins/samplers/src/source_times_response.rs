//! `kind: source-times-response`: the source's power times what the imager can see (the default).
//!
//! A density that is zero where any channel sees is a bias, so the product is mixed with 5 % of the
//! summed response of all channels. (A uniform floor over the band would cost ten times as much:
//! its strata straddle the edges of what a film sees.)

use crate::{Mixture, Quantiles};
use spectra_core::registry::SamplerEntry;
use spectra_core::spectral::SystemResponse;
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};

/// Share of the samples that follow the summed response alone.
const FLOOR: f64 = 0.05;

/// The strategy.
#[derive(Clone, Copy, Debug, Default)]
pub struct SourceTimesResponse;

impl WavelengthSampler for SourceTimesResponse {
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, String> {
        let grid = system.grid;
        let response = system.summed_response();
        let product: Vec<f64> = system.source.continuum.iter().zip(&response).map(|(s, r)| s.abs() * r).collect();
        let of_continuum = grid.integrate(&product);
        let of_response = grid.integrate(&response);
        if of_response <= 0.0 {
            return Err("no channel sees anything in the band".to_owned());
        }
        let weights: Vec<f64> =
            system.source.lines.iter().map(|l| l.power.abs() * grid.interpolate(&response, l.wavelength_nm)).collect();
        let of_lines: f64 = weights.iter().sum();
        let has_continuum = system.source.continuum.iter().any(|v| *v != 0.0);
        // A continuum that is seen nowhere is dark, but it may be lit elsewhere on the source: keep it if it is there.
        let continuum = (has_continuum || of_lines == 0.0)
            .then(|| {
                let scale = if of_continuum > 0.0 { (1.0 - FLOOR) / of_continuum } else { 0.0 };
                let density: Vec<f64> =
                    product.iter().zip(&response).map(|(p, r)| p * scale + r * FLOOR / of_response).collect();
                Quantiles::of(grid, &density)
            })
            .flatten();
        let share = (of_lines / (of_lines + of_continuum)).clamp(FLOOR, 1.0 - FLOOR);
        Mixture::new(&system.source.lines, &weights, share, continuum)
            .map(|m| Box::new(m) as Box<dyn WavelengthDensity>)
            .ok_or_else(|| "the imager sees none of the source's light".to_owned())
    }
}

inventory::submit! {
    SamplerEntry::new(
        "source-times-response",
        "The source's power times what the imager sees; lines as lines.",
        env!("CARGO_PKG_NAME"),
        env!("CARGO_PKG_VERSION"),
        |params, _| crate::no_params(params).map(|()| Box::new(SourceTimesResponse) as Box<dyn WavelengthSampler>),
    )
    .or_default()
}
