//! The spectrum of `kind: scale`.

use super::{SpectrumContext, SpectrumEntry, SpectrumForm, SpectrumKind, build_kind};
use crate::any_spectrum::AnySpectrum;
use crate::error::SpectrumError;
use crate::meta::Kind;
use crate::pending_spectrum::{PendingSpectrum, function_of, spectrum_of_function};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Deferred, Faults, Luminance, NonNegative, Power};

/// A spectrum that is made brighter or darker.
///
/// Scales by a factor or to a peak, and light also to a power or a luminance. Use it to say how bright a lamp with a relative
/// spectrum is.
///
/// # Example
/// ```yaml
/// {kind: scale, spectrum: D65, luminance: 120 cd/m2}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Scaled {
    /// Spectrum to scale, by name or as a map with its `kind`.
    spectrum: Deferred<SpectrumForm>,
    /// Factor to multiply by. Exactly one of `factor`, `peak`, `power` and `luminance` is given.
    factor: Option<NonNegative<f64>>,
    /// Largest value afterwards.
    peak: Option<NonNegative<f64>>,
    /// Power over 350-830 nm afterwards, W if bare; for light only.
    power: Option<Power>,
    /// Luminance afterwards, cd/m2 if bare; for light only.
    luminance: Option<Luminance>,
}

spectra_core::register!(SpectrumEntry, "scale": Scaled, build_kind::<Scaled>);

impl SpectrumKind for Scaled {
    fn make(&self, making: &SpectrumContext<'_>) -> Result<PendingSpectrum, Faults> {
        let params = making.params();
        let piece = making.nested(&self.spectrum, making.wanted())?;
        let said = [self.factor.is_some(), self.peak.is_some(), self.power.is_some(), self.luminance.is_some()];
        if said.iter().filter(|s| **s).count() != 1 {
            let fault = params.fault_here("a scale takes one of `factor`, `peak`, `power` and `luminance`");
            return Err(fault.into());
        }
        if let Some(factor) = self.factor {
            return piece.scaled(factor.get()).map_err(making.at("factor"));
        }
        if let (Some(peak), PendingSpectrum::Bare(shape)) = (self.peak, &piece) {
            let highest = shape.extremes().1;
            if !(highest > 0.0 && highest.is_finite()) {
                return Err(params.fault("peak", "the spectrum has no peak to scale").into());
            }
            let scaled = shape.scaled(peak.get() / highest).map_err(making.at("peak"))?;
            return Ok(PendingSpectrum::Bare(scaled));
        }
        let found = piece.into_any(Kind::Emission).map_err(making.at("spectrum"))?;
        let (key, scaled) = match (found, self.peak, self.power, self.luminance) {
            (AnySpectrum::Emission(light), Some(peak), ..) => {
                ("peak", light.scaled_to_peak().and_then(|l| l.scaled(peak.get())).map(AnySpectrum::Emission))
            }
            (AnySpectrum::Emission(light), _, Some(power), _) => {
                ("power", light.scaled_to_power(power.w()).map(AnySpectrum::Emission))
            }
            (AnySpectrum::Emission(light), _, _, Some(luminance)) => {
                ("luminance", light.scaled_to_luminance(luminance.cd_per_m2()).map(AnySpectrum::Emission))
            }
            (matter, Some(peak), ..) => ("peak", to_peak(matter, peak.get())),
            (matter, ..) => {
                let text =
                    format!("only light can be scaled to a power or a luminance; this is of kind {}", matter.kind());
                return Err(params.fault("spectrum", text).into());
            }
        };
        scaled.map(PendingSpectrum::Typed).map_err(making.at(key))
    }
}

fn to_peak(matter: AnySpectrum, peak: f64) -> Result<AnySpectrum, SpectrumError> {
    let Some(shape) = function_of(&matter) else { return Ok(matter) };
    let highest = shape.extremes().1;
    if !(highest > 0.0 && highest.is_finite()) {
        return Err(SpectrumError::NothingToScale("peak"));
    }
    spectrum_of_function(shape.scaled(peak / highest)?, matter.kind())
}
