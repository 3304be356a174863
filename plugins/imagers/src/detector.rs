//! `imager: detector`: a plane with any registered response. [`DetectorPlane`] is the base of other plane imagers, too.

use crate::params::Frame;
use crate::plane::Plane;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::cover::CoverStack;
use spectra_core::frame::{DisplayPicture, ExposureFrame, ExtraRequest, FinishedPicture, FrameSize, ImageState};
use spectra_core::params::{Deferred, Faults, Params, Positive, Time};
use spectra_core::registry::{self, Context, StageOf};
use spectra_core::spectral::Channel;
use spectra_core::stage::{Digitize, Imager, Launch, Receive, Response};

/// A frame of detectors with any `response`.
///
/// Use it for detectors of your own (sensitivities from files), a light meter or the eye at night. Each channel holds the
/// integral of irradiance times response. With an exposure time it is multiplied by the seconds.
///
/// # Example
/// ```yaml
/// kind: detector
/// format: 135
/// resolution: [600, 400]
/// response: {kind: sensitivities, channels: {gray: "gaussian:550,40"}}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(deny_unknown_fields)]
pub struct DetectorParams {
    #[serde(flatten)]
    frame: Frame,
    /// Spectral response of the detectors: their channels.
    response: Deferred<StageOf<dyn Response>>,
    /// Exposure time, s if bare. If it is given, the channels are multiplied by it.
    #[serde(default)]
    exposure: Option<Positive<Time>>,
}

/// A plane imager whose pixels all have the same response.
#[derive(Clone, Debug)]
pub struct DetectorPlane<R> {
    pub(crate) plane: Plane,
    pub(crate) response: R,
    pub(crate) exposure_time_s: Option<f64>,
}

impl<R: Response> DetectorPlane<R> {
    /// Creates an imager on the frame `plane` whose pixels have the response `response`. With an exposure time, in s, they
    /// integrate light over it; with `None` they record irradiance itself.
    #[must_use]
    pub fn of(plane: Plane, response: R, exposure_time_s: Option<f64>) -> Self {
        Self { plane, response, exposure_time_s }
    }
}

impl<R: Response> Imager for DetectorPlane<R> {
    fn size(&self) -> FrameSize {
        self.plane.size()
    }

    fn response(&self) -> Option<&dyn Response> {
        Some(self)
    }

    fn receive(&self) -> Option<&dyn Receive> {
        Some(&self.plane)
    }

    fn launch(&self) -> Option<&dyn Launch> {
        Some(&self.plane)
    }

    fn cover(&self) -> Option<CoverStack> {
        self.plane.cover()
    }
}

impl<R: Response> Response for DetectorPlane<R> {
    fn channels(&self) -> Vec<Channel> {
        let timed = self.exposure_time_s.is_some();
        let named = |c: Channel| if timed { Channel { unit: format!("{} s", c.unit), ..c } } else { c };
        self.response.channels().into_iter().map(named).collect()
    }

    fn exposure_time_s(&self) -> Option<f64> {
        self.exposure_time_s
    }

    fn display(&self, exposure: &ExposureFrame) -> Option<DisplayPicture> {
        self.response.display(exposure)
    }

    fn finish(&self, exposure: &ExposureFrame, wanted: ExtraRequest) -> Option<FinishedPicture> {
        self.response.finish(exposure, wanted)
    }

    fn image_state(&self) -> ImageState {
        self.response.image_state()
    }

    fn digitize(&self) -> Option<&dyn Digitize> {
        self.response.digitize()
    }
}

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Imager>, Faults> {
    let parsed: DetectorParams = params.parse()?;
    let mut faults = Faults::new();
    let plane = faults.take(parsed.frame.plane(params, context));
    let response = parsed.response.params().and_then(|p| registry::build::<dyn Response>(&p, context));
    let (Some(plane), Some(response)) = (plane, faults.take(response)) else { return Err(faults) };
    Ok(Box::new(DetectorPlane::of(plane, response, parsed.exposure.map(|t| t.s()))))
}

spectra_core::register!(imager "detector": DetectorParams, build);
