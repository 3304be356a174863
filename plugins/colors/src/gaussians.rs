//! The color model `gaussians`: each channel is one Gaussian.

use crate::Basis;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::exp;
use spectra_core::params::{Faults, Params, Positive, Wavelength};
use spectra_core::registry::Context;
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::ColorModel;

/// The Gaussian of one channel: center and standard deviation.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Bell {
    /// Wavelength of the peak, nm if bare.
    center: Wavelength,
    /// Standard deviation, nm if bare.
    sigma: Positive<Wavelength>,
}

/// One Gaussian per channel, scaled so that white has the illuminant's chromaticity.
///
/// Use it for displays with narrow primaries, and to study the effect of their width on film. Each of red, green and blue
/// is exp(-(w - center)^2 / (2 sigma^2)) times the linear value of its channel. White has the chromaticity of the source's
/// illuminant; if no positive mixture of the three has it, the scene is refused.
///
/// The colors of the Gaussians are not those of sRGB: saturated colors change, more so with narrower Gaussians.
///
/// # Example
/// ```yaml
/// {kind: gaussians}
/// ```
/// ```yaml
/// {kind: gaussians, R: {center: 630, sigma: 10}, G: {center: 532, sigma: 12}, B: {center: 465 nm, sigma: 9 nm}}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct GaussiansParams {
    /// Red channel; center 611 nm and sigma 24 nm if left out.
    #[serde(rename = "R")]
    red: Option<Bell>,
    /// Green channel; center 545 nm and sigma 26 nm if left out.
    #[serde(rename = "G")]
    green: Option<Bell>,
    /// Blue channel; center 460 nm and sigma 22 nm if left out.
    #[serde(rename = "B")]
    blue: Option<Bell>,
}

/// Default centers and standard deviations, nm. The centers are near the dominant wavelengths of the sRGB primaries (611, 549, 464 nm);
/// the Gaussians are wide enough to overlap without a gap.
const DEFAULTS: [[f64; 2]; 3] = [[611.0, 24.0], [545.0, 26.0], [460.0, 22.0]];

spectra_core::register!(color "gaussians": GaussiansParams, build);

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn ColorModel>, Faults> {
    let p: GaussiansParams = params.parse()?;
    let bells = [p.red, p.green, p.blue];
    let mut channel = 0;
    let spectra = DEFAULTS.map(|default| {
        let [center, sigma] = bells[channel].map_or(default, |b| [b.center.nm(), b.sigma.nm()]);
        channel += 1;
        let value = |w: f64| exp(-0.5 * ((w - center) / sigma) * ((w - center) / sigma));
        SpectralPower {
            continuum: context.grid.wavelengths_nm().map(value).collect(),
            ..SpectralPower::dark(context.grid)
        }
    });
    match context.illuminant {
        None => Ok(Box::new(Basis::new(&spectra))),
        Some(white) => match Basis::balanced(spectra, white) {
            Some(basis) => Ok(Box::new(basis)),
            None => {
                let fault = params.fault("R", "no mixture of these Gaussians has the color of the illuminant");
                Err(fault.hint("move their centers apart, or choose another illuminant").into())
            }
        },
    }
}
