//! The color model `primaries`: three smooth emission spectra with exactly the colors of the sRGB primaries.

use crate::Basis;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_color::srgb_primaries;
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;
use spectra_core::stage::ColorModel;

/// The sum of three smooth spectra that have exactly the colors of the sRGB primaries.
///
/// A color is red, green and blue light in the amounts of its linear sRGB values. Each of the three spectra is smooth and
/// non-negative, so a colorimeter measures the picture's own colors, and film gives reasonable ones. The three are scaled
/// so that white has the chromaticity of the source's illuminant; an illuminant outside their triangle is refused.
///
/// It is a model of light, such as that of a screen, not of surfaces. On film, leaves come out brown and skin pale, because
/// the spectrum has red, green and blue peaks where reflected light is smooth. For photographs and renders of objects use
/// `kind: smooth`, the default.
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
    // Without an illuminant, white is the white of sRGB, which differs from tabulated D65 by 3e-5 in x and y.
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
