//! `imager: xyz`: a plane that measures CIE 1931 XYZ in absolute units, a perfect tristimulus colorimeter.

use crate::balance::{Balance, WhiteBalance};
use crate::detector::DetectorPlane;
use crate::params::Frame;
use crate::plane::Plane;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_color::Gamut;
use spectra_core::frame::{DisplayPicture, ExposureFrame, ExtraRequest, FinishedPicture};
use spectra_core::params::{Exposure, Fault, Faults, Illuminance, Params, Positive, Quantity, Time};
use spectra_core::registry::Context;
use spectra_core::spectral::{Channel, Grid};
use spectra_core::stage::{Imager, Response};
use spectra_film::display::{White, finish_xyz};
use spectra_spectrum::Observer;
use spectra_spectrum::constants::LUMINOUS_EFFICACY_LM_PER_W;

/// A frame that measures CIE 1931 XYZ in lux, or in lux-seconds if it has an exposure time.
///
/// Each pixel is a perfect tristimulus colorimeter without noise. Use it for measurements, and for pictures that show what
/// an eye would see there. Y is the illuminance on the frame (683 lm/W times V).
///
/// `resolution` is the number of pixels across and down. If its aspect ratio differs from that of the frame, the pixels
/// are not square. The frame lies in the image plane of the lens unless you shift it, tilt it (as on a view camera) or
/// curve it.
///
/// # Example
/// ```yaml
/// {kind: xyz, format: 135, resolution: [960, 640]}
/// ```
/// ```yaml
/// {kind: xyz, width: 24 mm, height: 24 mm, resolution: [512, 512], exposure: 1/60 s, white: 0.4 lx s, gamut: perceptual}
/// ```
/// ```yaml
/// {kind: xyz, format: 135, resolution: [960, 640], white-balance: {temperature: 3200 K}}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(deny_unknown_fields)]
pub struct XyzParams {
    #[serde(flatten)]
    frame: Frame,
    /// Exposure time, s if bare. With it the channels are in lx s, without it in lx.
    #[serde(default)]
    exposure: Option<Positive<Time>>,
    /// The Y that the picture shows as white, with its unit: an illuminance such as `20 lx`, or an exposure such as
    /// `0.4 lx s` if an exposure time is given. If it is left out, automatic exposure shows the 99th percentile of Y as
    /// 0.9.
    #[serde(default)]
    white: Option<String>,
    /// Mapping of colors that a screen cannot show. `desaturate` (the default) keeps luminance; `perceptual` keeps perceived hue
    /// and lightness. `compress` adds white until they fit, so that the colors of a spectrum stay distinct. `clip` clips red,
    /// green and blue separately, which looks vivid.
    #[serde(default)]
    gamut: Option<GamutMapping>,
    /// Light that the picture shows as white. Write the name of a light or a file (`D55`, `A`, `"blackbody:3200"`), a color
    /// temperature as on a camera (`{temperature: 3200 K}`), or `auto-gray`, the mean of the frame. Temperatures are 1000 to
    /// 25000 K: a black body below 4000 K, daylight from there on. The channels do not change. If it is left out, the picture
    /// has the tint of its light.
    #[serde(default)]
    white_balance: Option<WhiteBalance>,
}

/// Mapping of colors that a screen cannot show, as written in a scene.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum GamutMapping {
    Desaturate,
    Perceptual,
    Compress,
    Clip,
}

/// A response with the channels X, Y and Z of CIE 1931, in lux.
#[derive(Clone, Debug)]
pub struct XyzResponse {
    channels: Vec<Channel>,
    white: White,
    gamut: Gamut,
    balance: Balance,
}

impl XyzResponse {
    /// Creates the channels X, Y and Z on `grid`. `white` is the exposure that the picture shows as white.
    #[must_use]
    pub fn new(grid: &Grid, white: White) -> Self {
        let functions = Observer::cie_1931_2deg().on_grid(grid);
        let channel = |(name, function): (&str, Vec<f64>)| Channel {
            name: name.into(),
            unit: "lx".into(),
            response: function.into_iter().map(|v| v * LUMINOUS_EFFICACY_LM_PER_W).collect(),
        };
        let channels = ["X", "Y", "Z"].into_iter().zip(functions).map(channel).collect();
        Self { channels, white, gamut: Gamut::Desaturate, balance: Balance::Screen }
    }
}

impl Response for XyzResponse {
    fn channels(&self) -> Vec<Channel> {
        self.channels.clone()
    }

    fn display(&self, exposure: &ExposureFrame) -> Option<DisplayPicture> {
        self.finish(exposure, ExtraRequest::default()).map(|finished| finished.display)
    }

    fn finish(&self, exposure: &ExposureFrame, wanted: ExtraRequest) -> Option<FinishedPicture> {
        let adapted = self.balance.matrix(exposure);
        finish_xyz(exposure, self.white, self.gamut, adapted.as_ref(), wanted).ok()
    }
}

/// A plane imager that measures XYZ.
pub type XyzPlane = DetectorPlane<XyzResponse>;

impl XyzPlane {
    /// Creates an imager on the frame `plane` with channels on `grid`. With an exposure time, in s, the channels are in lx s;
    /// with `None`, in lx. `white` is the exposure that the picture shows as white.
    #[must_use]
    pub fn new(plane: Plane, grid: &Grid, exposure_time_s: Option<f64>, white: White) -> Self {
        Self::of(plane, XyzResponse::new(grid, white), exposure_time_s)
    }

    /// Returns this imager with another mapping for colors that a screen cannot show.
    #[must_use]
    pub fn with_gamut(mut self, gamut: Gamut) -> Self {
        self.response.gamut = gamut;
        self
    }

    /// Returns this imager with another light shown as white in its picture.
    #[must_use]
    pub fn with_balance(mut self, balance: Balance) -> Self {
        self.response.balance = balance;
        self
    }
}

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Imager>, Faults> {
    let parsed: XyzParams = params.parse()?;
    let mut faults = Faults::new();
    let plane = faults.take(parsed.frame.plane(params, context));
    let XyzParams { exposure, white, gamut, white_balance, .. } = parsed;
    let white = match &white {
        None => Some(White::default()),
        Some(text) => faults.take(stated_white(params, text, exposure.is_some())),
    };
    let gamut = match gamut {
        None | Some(GamutMapping::Desaturate) => Gamut::Desaturate,
        Some(GamutMapping::Perceptual) => Gamut::Perceptual,
        Some(GamutMapping::Compress) => Gamut::Compress,
        Some(GamutMapping::Clip) => Gamut::Clip,
    };
    let balance = faults.take(WhiteBalance::read(white_balance.as_ref(), params, context));
    let (Some(plane), Some(white), Some(balance)) = (plane, white, balance) else {
        return Err(faults);
    };
    let imager = XyzPlane::new(plane, &context.grid, exposure.map(|t| t.s()), white);
    let imager = imager.with_gamut(gamut).with_balance(balance);
    faults.into_result(Box::new(imager))
}

/// Reads the white in the unit of the channels: an exposure if there is an exposure time, otherwise an illuminance.
fn stated_white(params: &Params, text: &str, timed: bool) -> Result<White, Fault> {
    let white = if timed {
        Positive::<Exposure>::from_text(text).map(|v| v.lx_s())
    } else {
        Positive::<Illuminance>::from_text(text).map(|v| v.lx())
    };
    white.map(White::Stated).map_err(|fault| Fault { hint: fault.hint, ..params.fault("white", fault.message) })
}

spectra_core::register!(imager "xyz": XyzParams, build);
