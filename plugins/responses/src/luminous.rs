//! The responses `photopic` and `scotopic`: light weighted by the sensitivity of the eye.

use crate::picture::finish;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::{DisplayPicture, ExposureFrame, ExtraRequest, FinishedPicture};
use spectra_core::params::{Faults, Params, Positive};
use spectra_core::registry::Context;
use spectra_core::spectral::{Channel, Grid};
use spectra_core::stage::Response;
use spectra_spectrum::constants::LUMINOUS_EFFICACY_LM_PER_W;
use spectra_spectrum::{Sensitivity, v_lambda, v_prime};

/// Scotopic luminous efficacy at the peak of V', lm/W (CIE 018:2019: 683 V'(507) / V'(555) = 1700).
const SCOTOPIC_EFFICACY_LM_PER_W: f64 = 1700.0;

/// A light meter: illuminance by V(lambda), in lux; the picture is gray.
///
/// Each pixel holds the reading of a luxmeter in the image plane. Use it for the falloff of light toward the corners, or
/// for the light of a lamp on a wall.
///
/// # Example
/// ```yaml
/// {kind: photopic, white: 500}
/// ```
/// # References
/// - CIE 018:2019, The Basis of Physical Photometry.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct PhotopicParams {
    /// Illuminance that the picture shows as white, lux (lux-seconds on a detector with an exposure time); automatic if left out.
    pub white: Option<Positive<f64>>,
}

/// The eye at night: scotopic illuminance by V'(lambda), in scotopic lux; the picture is gray.
///
/// Compared with daylight vision, blue becomes lighter and red darker, as J. E. Purkinje observed.
///
/// # Example
/// ```yaml
/// {kind: scotopic}
/// ```
/// # References
/// - CIE 018:2019, The Basis of Physical Photometry.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct ScotopicParams {
    /// Illuminance that the picture shows as white, scotopic lux (lux-seconds on a detector with an exposure time); automatic if left
    /// out.
    pub white: Option<Positive<f64>>,
}

/// A response of one channel that is weighted by the sensitivity of the eye.
#[derive(Clone, Debug)]
pub struct Luminous {
    channel: Channel,
    white: Option<f64>,
}

impl Luminous {
    fn new(name: &str, seen: &Sensitivity, per_watt: f64, grid: &Grid, white: Option<Positive<f64>>) -> Self {
        let response = seen.on_grid(grid).into_iter().map(|v| v * per_watt).collect();
        let channel = Channel { name: name.into(), unit: "lx".into(), response };
        Self { channel, white: white.map(|w| w.get()) }
    }
}

impl Response for Luminous {
    fn channels(&self) -> Vec<Channel> {
        vec![self.channel.clone()]
    }

    fn display(&self, exposure: &ExposureFrame) -> Option<DisplayPicture> {
        self.finish(exposure, ExtraRequest::default()).map(|finished| finished.display)
    }

    fn finish(&self, exposure: &ExposureFrame, wanted: ExtraRequest) -> Option<FinishedPicture> {
        let values = &exposure.channel(&self.channel.name)?.values;
        finish(exposure, self.white, wanted, |pixel| [f64::from(values[pixel]); 3])
    }
}

fn photopic(params: &Params, context: &Context<'_>) -> Result<Box<dyn Response>, Faults> {
    let PhotopicParams { white } = params.parse()?;
    Ok(Box::new(Luminous::new("photopic", &v_lambda(), LUMINOUS_EFFICACY_LM_PER_W, &context.grid, white)))
}

fn scotopic(params: &Params, context: &Context<'_>) -> Result<Box<dyn Response>, Faults> {
    let ScotopicParams { white } = params.parse()?;
    Ok(Box::new(Luminous::new("scotopic", &v_prime(), SCOTOPIC_EFFICACY_LM_PER_W, &context.grid, white)))
}

spectra_core::register!(response "photopic": PhotopicParams, photopic);
spectra_core::register!(response "scotopic": ScotopicParams, scotopic);
