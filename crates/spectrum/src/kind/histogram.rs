//! The spectrum of `kind: histogram`.

use super::{SpectrumContext, SpectrumEntry, SpectrumKind, build_kind, lengths, rising, some_light};
use crate::pending_spectrum::PendingSpectrum;
use crate::spectral_function::SpectralFunction;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Wavelength};

/// A spectrum that a detector measured in bins.
///
/// Counts between neighboring edges, as a spectrometer or a simulation delivers them; each bin keeps its own content.
///
/// # Example
/// ```yaml
/// {kind: histogram, edges: [400, 500, 600, 700], counts: [3, 8, 5]}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Histogram {
    /// Edges of the bins, nm if bare, in ascending order.
    #[schemars(length(min = 2))]
    edges: Vec<Wavelength>,
    /// Counts between neighboring edges, one fewer than edges; 0 or more.
    counts: Vec<f64>,
}

spectra_core::register!(SpectrumEntry, "histogram": Histogram, build_kind::<Histogram>);

impl SpectrumKind for Histogram {
    fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults> {
        let params = making.params();
        let wanted = [self.counts.len(), self.edges.len().saturating_sub(1)];
        lengths(params, ["edges", "counts"], wanted, "the list of edges")?;
        let mut faults = Faults::new();
        rising(params, "edges", &self.edges, &mut faults);
        some_light(params, "edges", &self.edges, &mut faults);
        for (i, count) in self.counts.iter().enumerate().filter(|(_, c)| **c < 0.0) {
            let fault = params.fault(&format!("counts[{i}]"), format!("a count cannot be negative: {count}"));
            faults.push(fault.hint("write 0 where nothing was counted"));
        }
        faults.into_result(())?;
        let edges: Vec<f64> = self.edges.iter().map(|w| w.nm()).collect();
        SpectralFunction::histogram(&edges, &self.counts).map(PendingSpectrum::Bare).map_err(making.at("counts"))
    }
}
