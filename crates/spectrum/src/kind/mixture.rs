//! The spectrum of `kind: mixture`.

use super::gaussian::Center;
use super::{SpectrumContext, SpectrumEntry, SpectrumKind, build_kind};
use crate::gaussian::{GaussianMixture, GaussianTerm};
use crate::pending_spectrum::PendingSpectrum;
use crate::spectral_function::SpectralFunction;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Positive, Wavelength};

/// A sum of signed Gaussians.
///
/// `spectra spectrum fit` makes such a sum of a table: it is smooth, compact, and known at every wavelength.
///
/// # Example
/// ```yaml
/// kind: mixture
/// terms:
///   - {amplitude: 0.9, center: 560, sigma: 300}
///   - {amplitude: -0.5, center: 520, sigma: 25}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Mixture {
    /// Signed Gaussians, 1 to 4096; where their sum is negative it counts as 0, unless the mixture is a part of a `sum`.
    // More than any fit has, and than a product of several that is written out.
    #[schemars(length(min = 1, max = 4096))]
    terms: Vec<Term>,
}

/// One signed Gaussian.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Term {
    /// Value at the center, of either sign.
    amplitude: f64,
    /// Wavelength of the center, nm if bare; it may lie outside of all light.
    center: Center,
    /// Standard deviation, nm if bare.
    sigma: Positive<Wavelength>,
}

spectra_core::register!(SpectrumEntry, "mixture": Mixture, build_kind::<Mixture>);

impl SpectrumKind for Mixture {
    fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults> {
        let params = making.params();
        let mut faults = Faults::new();
        let term = |(i, t): (usize, &Term)| {
            let term = GaussianTerm::new(t.amplitude, t.center.0, t.sigma.nm());
            faults.take(term.map_err(|e| params.fault(&format!("terms[{i}]"), e.to_string())))
        };
        let terms: Vec<GaussianTerm> = self.terms.iter().enumerate().filter_map(term).collect();
        faults.into_result(())?;
        let mixture = GaussianMixture::new(terms);
        if making.is_part() {
            return Ok(PendingSpectrum::Bare(SpectralFunction::mixture(mixture)));
        }
        let shape = SpectralFunction::positive_mixture(mixture).map_err(making.at("terms"))?;
        Ok(PendingSpectrum::Bare(shape.0))
    }
}
