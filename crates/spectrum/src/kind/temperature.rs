//! The spectra of `kind: blackbody` and `kind: daylight`.

use super::{SpectrumContext, SpectrumEntry, SpectrumKind, build_kind};
use crate::emission::Emission;
use crate::illuminants::daylight;
use crate::inline::measure;
use crate::pending_spectrum::PendingSpectrum;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Temperature};

/// Light of a blackbody by Planck's law, W m^-2 sr^-1 nm^-1.
///
/// Use it for the light of incandescent lamps, candles and, at 5800 K, roughly that of the sun. As an expression: `blackbody:2856`.
///
/// # Example
/// ```yaml
/// {kind: blackbody, temperature: 2856 K}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Blackbody {
    /// Temperature of the blackbody, K if bare.
    temperature: Temperature,
}

/// CIE daylight of a correlated color temperature, relative.
///
/// Covers the phases of daylight from 4000 to 25000 K; D65 is one of them. As an expression: `daylight:5500`.
///
/// # Example
/// ```yaml
/// {kind: daylight, temperature: 5500 K}
/// ```
///
/// # References
/// - CIE 15:2004, Colorimetry, section 3.1.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Daylight {
    /// Correlated color temperature, K if bare.
    temperature: Temperature,
}

spectra_core::register!(SpectrumEntry, "blackbody": Blackbody, build_kind::<Blackbody>);
spectra_core::register!(SpectrumEntry, "daylight": Daylight, build_kind::<Daylight>);
crate::expression!("blackbody:5800", "write a temperature in kelvin, such as blackbody:5800", |text| {
    measure(text, "K").map(|kelvin| Emission::blackbody(kelvin).map(PendingSpectrum::from))
});
crate::expression!("daylight:5500", "write a temperature in kelvin, such as daylight:5500", |text| {
    measure(text, "K").map(|kelvin| daylight(kelvin).map(PendingSpectrum::from))
});

impl SpectrumKind for Blackbody {
    fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults> {
        Emission::blackbody(self.temperature.kelvin()).map(PendingSpectrum::from).map_err(making.at("temperature"))
    }
}

impl SpectrumKind for Daylight {
    fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults> {
        daylight(self.temperature.kelvin()).map(PendingSpectrum::from).map_err(making.at("temperature"))
    }
}
