//! The spectrum of `kind: constant`.

use super::{SpectrumContext, SpectrumEntry, SpectrumKind, build_kind};
use crate::inline::numbers;
use crate::pending_spectrum::PendingSpectrum;
use crate::spectral_function::SpectralFunction;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, NonNegative};

/// A constant value at every wavelength.
///
/// As light it is the equal-energy spectrum; as a filter or a surface it is a neutral gray. As an expression: `constant:0.18`,
/// or `constant` for 1.
///
/// # Example
/// ```yaml
/// {kind: constant, value: 0.18}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Constant {
    /// Value at every wavelength; 1 if absent.
    value: Option<NonNegative<f64>>,
}

spectra_core::register!(SpectrumEntry, "constant": Constant, build_kind::<Constant>);
crate::expression!("constant:1", "write a value, such as constant:0.18", |text| {
    let [value] = numbers(text)?.try_into().ok()?;
    Some(SpectralFunction::constant(value).map(PendingSpectrum::Bare))
});

impl SpectrumKind for Constant {
    fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults> {
        SpectralFunction::constant(self.value.map_or(1.0, NonNegative::get))
            .map(PendingSpectrum::Bare)
            .map_err(making.at("value"))
    }
}
