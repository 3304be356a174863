//! `kind: primaries`: three smooth emission spectra that are exactly the primaries of sRGB.

use crate::Basis;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_color::srgb_primaries;
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;
use spectra_core::stage::ColorModel;

/// The sum of three smooth spectra that have exactly the colors of the sRGB primaries.
///
/// A color is red, green and blue light in the amounts of its linear sRGB values; each of the three
/// spectra is smooth and non-negative, so a colorimeter measures the picture's own colors, and film gives reasonable
/// ones. White has the chromaticity of the source's illuminant: the three are scaled for that, and an illuminant
/// outside of their triangle is refused.
///
/// It is a model of light, as of a screen, not of surfaces: film sees leaves as brown and skin as pale, since red, green and blue
/// light stand where reflected light is smooth. For photographs and renders of objects use `kind: smooth`, the default.
///
/// # Example
/// ```yaml
/// {kind: primaries}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PrimariesParams {}

spectra_core::register!(color "primaries": PrimariesParams, build);

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn ColorModel>, Faults> {
    let PrimariesParams {} = params.parse()?;
    let spectra = srgb_primaries().each_ref().map(|light| light.to_power(&context.grid));
    // Without an illuminant white is that of sRGB; D65 as tabulated differs from it by 3e-5 in x and y.
    let basis = match context.illuminant {
        None => Some(Basis::new(&spectra)),
        Some(white) => Basis::balanced(spectra, white),
    };
    match basis {
        Some(basis) => Ok(Box::new(basis)),
        None => {
            let fault = params.fault("kind", "no mixture of the sRGB primaries has the color of the illuminant");
            Err(fault.hint("choose another illuminant, or `kind: smooth`").into())
        }
    }
}
