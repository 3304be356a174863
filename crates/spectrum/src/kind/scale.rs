//! The spectrum of `kind: scale`.

use super::{Making, SpectrumEntry, SpectrumForm, SpectrumKind, build_kind};
use crate::error::SpectrumError;
use crate::found::Found;
use crate::meta::Kind;
use crate::piece::{Piece, of_shape, shape_of};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Luminance, NonNegative, Part, Power};

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
    spectrum: Part<SpectrumForm>,
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
    fn make(&self, making: &Making<'_>) -> Result<Piece, Faults> {
        let params = making.params();
        let piece = making.part(&self.spectrum, making.wanted())?;
        let said = [self.factor.is_some(), self.peak.is_some(), self.power.is_some(), self.luminance.is_some()];
        if said.iter().filter(|s| **s).count() != 1 {
            let fault = params.fault_here("a scale takes one of `factor`, `peak`, `power` and `luminance`");
            return Err(fault.into());
        }
        if let Some(factor) = self.factor {
            return piece.scaled(factor.get()).map_err(making.at("factor"));
        }
        if let (Some(peak), Piece::Bare(shape)) = (self.peak, &piece) {
            let highest = shape.extremes().1;
            if !(highest > 0.0 && highest.is_finite()) {
                return Err(params.fault("peak", "the spectrum has no peak to scale").into());
            }
            let scaled = shape.scaled(peak.get() / highest).map_err(making.at("peak"))?;
            return Ok(Piece::Bare(scaled));
        }
        let found = piece.into_found(Kind::Emission).map_err(making.at("spectrum"))?;
        let (key, scaled) = match (found, self.peak, self.power, self.luminance) {
            (Found::Emission(light), Some(peak), ..) => {
                ("peak", light.scaled_to_peak().and_then(|l| l.scaled(peak.get())).map(Found::Emission))
            }
            (Found::Emission(light), _, Some(power), _) => {
                ("power", light.scaled_to_power(power.w()).map(Found::Emission))
            }
            (Found::Emission(light), _, _, Some(luminance)) => {
                ("luminance", light.scaled_to_luminance(luminance.cd_per_m2()).map(Found::Emission))
            }
            (matter, Some(peak), ..) => ("peak", to_peak(matter, peak.get())),
            (matter, ..) => {
                let text =
                    format!("only light can be scaled to a power or a luminance; this is of kind {}", matter.kind());
                return Err(params.fault("spectrum", text).into());
            }
        };
        scaled.map(Piece::Typed).map_err(making.at(key))
    }
}

fn to_peak(matter: Found, peak: f64) -> Result<Found, SpectrumError> {
    let Some(shape) = shape_of(&matter) else { return Ok(matter) };
    let highest = shape.extremes().1;
    if !(highest > 0.0 && highest.is_finite()) {
        return Err(SpectrumError::NothingToScale("peak"));
    }
    of_shape(shape.scaled(peak / highest)?, matter.kind())
}
