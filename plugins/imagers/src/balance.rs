//! White balance: the light that a picture shows as white.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_color::matrix::Matrix;
use spectra_color::{Adaptation, RgbSpace};
use spectra_core::frame::ExposureFrame;
use spectra_core::params::{Faults, Params, Temperature};
use spectra_core::registry::Context;
use spectra_core::spectral::BAND;
use spectra_spectrum::{Observer, find_emission_in};

/// `white-balance` as written in a scene: the light that is shown as white.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub(crate) enum WhiteBalance {
    /// The name of a light, or `auto-gray`.
    Named(String),
    /// A light given by its color temperature.
    Of(OfTemperature),
}

/// A light given by its color temperature.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub(crate) struct OfTemperature {
    /// Correlated color temperature of the light, K if bare.
    #[schemars(range(min = 1000, max = 25000))]
    temperature: Temperature,
}

/// The light that the picture shows as white. Colors are adapted from it to the white of the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Balance {
    /// The screen's white: colors are not balanced.
    #[default]
    Screen,
    /// A white with these XYZ values.
    White([f64; 3]),
    /// The mean color of the frame.
    AutoGray,
}

impl Balance {
    /// Returns the matrix (CAT02) from XYZ of the frame to XYZ under D65. `None` if there is nothing to balance, or if the
    /// frame is dark.
    pub(crate) fn matrix(self, frame: &ExposureFrame) -> Option<Matrix> {
        let white = match self {
            Self::Screen => return None,
            Self::White(white) => white,
            Self::AutoGray => {
                let lit = |v: &&f32| v.is_finite() && **v > 0.0;
                // Summed serially, so that the sum is the same with any number of threads.
                let sum = |name: &str| {
                    Some(frame.channel(name)?.values.iter().filter(lit).fold(0.0, |sum, v| sum + f64::from(*v)))
                };
                [sum("X")?, sum("Y")?, sum("Z")?]
            }
        };
        let one = white.map(|v| v / white[1]);
        let matrix = Adaptation::Cat02.matrix(one, RgbSpace::srgb().white_xyz());
        matrix.iter().flatten().all(|v| v.is_finite()).then_some(matrix)
    }
}

impl WhiteBalance {
    /// Reads the key `white-balance`. If it is left out, colors are not balanced.
    pub(crate) fn read(stated: Option<&Self>, params: &Params, context: &Context<'_>) -> Result<Balance, Faults> {
        stated.map_or(Ok(Balance::Screen), |stated| balanced(params, stated, context))
    }
}

/// Below this temperature, K, a light is a black body, from here on daylight. CIE 015 defines no daylight below it.
const WARMEST_DAYLIGHT_K: f64 = 4000.0;

/// Finds the light that is shown as white and computes its XYZ.
fn balanced(params: &Params, balance: &WhiteBalance, context: &Context<'_>) -> Result<Balance, Faults> {
    let name = match balance {
        WhiteBalance::Named(name) if name == "auto-gray" => return Ok(Balance::AutoGray),
        WhiteBalance::Named(name) => name.clone(),
        WhiteBalance::Of(OfTemperature { temperature }) => {
            let kelvin = temperature.kelvin();
            let kind = if kelvin < WARMEST_DAYLIGHT_K { "blackbody" } else { "daylight" };
            format!("{kind}:{kelvin}")
        }
    };
    let key = "white-balance";
    let light = find_emission_in(&name, context.resources).map_err(|e| e.faults(|text| params.fault(key, text)))?;
    let xyz = Observer::cie_1931_2deg().xyz_of_power(&light.to_power(&BAND));
    if !(xyz[1] > 0.0 && xyz.iter().all(|v| v.is_finite())) {
        let fault = params.fault(key, format!("`{name}` has no visible light"));
        return Err(fault.hint("write another light, such as `D55`, or `auto-gray`").into());
    }
    Ok(Balance::White(xyz))
}
