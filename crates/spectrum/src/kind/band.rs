//! The spectrum of `kind: rectangle`.

use super::{SpectrumContext, SpectrumEntry, SpectrumKind, build_kind, times};
use crate::error::SpectrumError;
use crate::inline::wavelengths;
use crate::pending_spectrum::PendingSpectrum;
use crate::spectral_function::SpectralFunction;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, NonNegative, Wavelength};
use spectra_core::quantity::light_nm;

/// A constant value between two wavelengths, and 0 outside.
///
/// Use it for an ideal band-pass filter, or for light of a band with sharp ends. As an expression: `rectangle:500,600`.
///
/// # Example
/// ```yaml
/// {kind: rectangle, from: 500 nm, to: 600 nm}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Rectangle {
    /// Lower edge, nm if bare.
    from: Wavelength,
    /// Upper edge, nm if bare.
    to: Wavelength,
    /// Value between the edges; 1 if absent. Outside it is 0.
    value: Option<NonNegative<f64>>,
}

spectra_core::register!(SpectrumEntry, "rectangle": Rectangle, build_kind::<Rectangle>);
crate::expression!("rectangle:500,600", "write two wavelengths in nm, such as rectangle:500,600", |text| {
    let [from, to] = wavelengths(text)?.try_into().ok()?;
    Some(rectangle(from, to).map(PendingSpectrum::Bare))
});

impl SpectrumKind for Rectangle {
    fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults> {
        let shape = rectangle(self.from.nm(), self.to.nm());
        shape.and_then(|shape| times(shape, self.value)).map_err(making.at("to"))
    }
}

fn rectangle(from_nm: f64, to_nm: f64) -> Result<SpectralFunction, SpectrumError> {
    SpectralFunction::rectangle(from_nm, light_nm(to_nm)?)
}
