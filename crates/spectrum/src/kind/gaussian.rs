//! The spectrum of `kind: gaussian`, and the center of a Gaussian.

use super::{SpectrumContext, SpectrumEntry, SpectrumKind, bell_nm, build_kind, times};
use crate::error::SpectrumError;
use crate::inline::wavelengths;
use crate::pending_spectrum::PendingSpectrum;
use crate::spectral_function::SpectralFunction;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;
use spectra_core::params::{Dimension, Faults, NonNegative, Positive, Quantity, Wavelength, schema_of};
use spectra_core::quantity;

/// The center of a Gaussian, nm if bare. It may have any sign, since it may lie far outside of all light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Center(pub(super) f64);

impl Quantity for Center {
    const DIMENSION: Dimension = Dimension::Length;
    const NOUN: &'static str = "wavelength";
    const BARE_UNIT: &'static str = "nm";
    const EXAMPLE: &'static str = "550 nm";

    fn from_bare(value: f64) -> Self {
        Self(value)
    }

    fn bare(self) -> f64 {
        self.0
    }
}

impl JsonSchema for Center {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Center".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schema_of::<Self>()
    }
}

impl<'de> Deserialize<'de> for Center {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        quantity::deserialize(deserializer)
    }
}

/// A Gaussian: peak x exp(-(w - center)^2 / (2 sigma^2)).
///
/// Use it for an LED, a narrow filter or a band of absorption. As an expression: `gaussian:550,20`. Several together are a `mixture`.
///
/// # Example
/// ```yaml
/// {kind: gaussian, center: 550 nm, sigma: 20 nm}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Gaussian {
    /// Wavelength of the peak, nm if bare; it may lie outside of all light.
    center: Center,
    /// Standard deviation, nm if bare.
    sigma: Positive<Wavelength>,
    /// Value at the peak; 1 if absent.
    peak: Option<NonNegative<f64>>,
}

spectra_core::register!(SpectrumEntry, "gaussian": Gaussian, build_kind::<Gaussian>);
crate::expression!("gaussian:550,20", "write center and standard deviation in nm, such as gaussian:550,20", |text| {
    let [center, sigma] = wavelengths(text)?.try_into().ok()?;
    Some(gaussian(center, sigma).map(PendingSpectrum::Bare))
});

impl SpectrumKind for Gaussian {
    fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults> {
        bell_nm(self.center.0, self.sigma.nm()).map_err(making.at("center"))?;
        let shape = gaussian(self.center.0, self.sigma.nm());
        shape.and_then(|shape| times(shape, self.peak)).map_err(making.at("sigma"))
    }
}

fn gaussian(center_nm: f64, sigma_nm: f64) -> Result<SpectralFunction, SpectrumError> {
    SpectralFunction::gaussian(bell_nm(center_nm, sigma_nm)?, sigma_nm)
}
