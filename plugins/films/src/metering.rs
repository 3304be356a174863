//! The camera's light meter: metering modes, the metered area, and the exposure that follows.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::{ExposureFrame, FrameSize};
use spectra_core::params::{Fault, Params, Positive, Time};
use spectra_core::shutter;
use spectra_core::spectral::{Channel, Grid};
use spectra_film::print::metered_exposure_lx_s;
use spectra_spectrum::constants::LUMINOUS_EFFICACY_LM_PER_W;
use spectra_spectrum::v_lambda;

/// Name of the channel that the meter reads: photometric lux-seconds, or lux-seconds of the film's own sensitivity if the stock says so.
pub(crate) const METER: &str = "meter";

/// The value of `metering` as written in a scene: how the camera sets the exposure.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Metering {
    /// The scene states the exposure time.
    #[default]
    Manual,
    /// The mean of the frame is exposed as a mid gray.
    Average,
    /// The mean of a round spot is exposed as a mid gray.
    Spot,
    /// A center-weighted mean of the frame, in which no pixel counts for more than eight times the median, is exposed as a mid gray.
    Camera,
}

/// The value of `exposure` as written in a scene: a time, or `metered`.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ExposureParams {
    /// Exposure time, s if bare.
    Time(Positive<Time>),
    /// The word `metered`: the camera sets the exposure.
    Metered(MeteredWord),
}

/// The word `metered` as the value of `exposure`.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MeteredWord {
    /// The camera sets the exposure.
    Metered,
}

/// Exposure settings of a scene, from `exposure` and `metering` together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExposureSettings {
    /// Metering mode of the camera.
    pub metering: Metering,
    /// Whether a source picture that was exposed already keeps its exposure.
    pub keeps: bool,
    /// Time for which light is recorded, s: the scene's, or 1 s if the camera meters. The metered time does not depend on it.
    pub time_s: f64,
    /// Whether a stated exposure time has no effect, because the camera meters.
    pub is_overruled: bool,
}

impl ExposureSettings {
    /// Combines `exposure` and `metering`, either of which may be left out. Fails if neither says how to expose, or if they contradict
    /// each other.
    pub(crate) fn new(
        exposure: Option<ExposureParams>,
        metering: Option<Metering>,
        params: &Params,
    ) -> Result<Self, Fault> {
        let metered = |metering, keeps, is_overruled| Self { metering, keeps, time_s: 1.0, is_overruled };
        Ok(match (exposure, metering) {
            (Some(ExposureParams::Time(time)), None | Some(Metering::Manual)) => {
                Self { metering: Metering::Manual, keeps: false, time_s: time.s(), is_overruled: false }
            }
            (Some(ExposureParams::Time(_)), Some(metering)) => metered(metering, false, true),
            (Some(ExposureParams::Metered(_)), Some(Metering::Manual)) => {
                let fault = params.fault("metering", "`exposure: metered` is set by the camera, not by hand");
                return Err(fault.hint("leave `metering` out, or state a time, such as `exposure: 1/125 s`"));
            }
            // A stated metering mode means that the camera meters every source, even a picture that was exposed already.
            (Some(ExposureParams::Metered(_)), Some(metering)) => metered(metering, false, false),
            (Some(ExposureParams::Metered(_)), None) => metered(Metering::Camera, true, false),
            (None, None | Some(Metering::Manual)) => {
                let fault = params.fault("exposure", "missing key `exposure`");
                return Err(fault.hint("add `exposure: 1/125 s`, or let the camera find it: `exposure: metered`"));
            }
            (None, Some(metering)) => metered(metering, false, false),
        })
    }
}

/// The value of `meter` as written in a scene: the frames of an animation that the camera meters.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Metered {
    /// The first frame, which sets the exposure of all.
    #[default]
    First,
    /// Every frame sets its own exposure.
    Each,
}

/// The map `spot` as written in a scene: the round area that is metered.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct SpotParams {
    /// Center of the spot as fractions of the frame's width and height from the upper left corner, each 0 to 1.
    #[serde(default = "center")]
    #[schemars(inner(range(min = 0, max = 1)))]
    pub center: [f64; 2],
    /// Diameter of the spot as a fraction of the frame's height, above 0 to 4.
    #[serde(default = "diameter")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 4))]
    pub diameter: f64,
}

fn center() -> [f64; 2] {
    [0.5, 0.5]
}

fn diameter() -> f64 {
    0.1
}

/// Returns the warning that the meter overrules a stated exposure time, if it does.
pub(crate) fn overruled(is_overruled: bool) -> Vec<String> {
    let text = "the camera meters, so `exposure` has no effect; leave out either `metering` or `exposure`";
    if is_overruled { vec![text.to_owned()] } else { Vec::new() }
}

/// A light meter that is set to a film speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Meter {
    metering: Metering,
    spot: SpotParams,
    /// Exposure that the metered area is to get, lx s.
    target_lx_s: f64,
}

impl Meter {
    /// Creates a meter for the film speed `speed`, with an exposure compensation in stops. Fails if a spot or a compensation is given that
    /// the metering mode does not use.
    pub(crate) fn new(
        params: &Params,
        metering: Metering,
        spot: Option<SpotParams>,
        speed: f64,
        compensation: Option<f64>,
    ) -> Result<Self, Vec<Fault>> {
        let mut faults = Vec::new();
        if spot.is_some() && metering != Metering::Spot {
            faults.push(params.fault("spot", "only `metering: spot` has a spot"));
        }
        let spot = spot.unwrap_or(SpotParams { center: center(), diameter: diameter() });
        if compensation.is_some() && metering == Metering::Manual {
            let fault = params.fault("compensation", "without a meter there is nothing to compensate");
            faults.push(fault.hint("write `metering: average`, or a different `exposure`"));
        }
        let stops = compensation.unwrap_or(0.0);
        if !faults.is_empty() {
            return Err(faults);
        }
        let target_lx_s = metered_exposure_lx_s(speed) * spectra_core::math::pow(2.0, stops);
        Ok(Self { metering, spot, target_lx_s })
    }

    /// Returns whether the meter chooses the exposure time.
    pub(crate) fn is_on(&self) -> bool {
        self.metering != Metering::Manual
    }

    /// The metering mode in a word; `None` if the exposure is manual.
    pub(crate) fn word(&self) -> Option<&'static str> {
        self.is_on().then(|| self.metering.word())
    }

    /// Describes how the film is exposed; `exposure_time_s` is the scene's time, s.
    pub(crate) fn words(&self, exposure_time_s: f64) -> String {
        match self.metering {
            Metering::Manual => format!("exposed for {}", shutter::format_time(exposure_time_s)),
            metered => format!("metered ({})", metered.word()),
        }
    }

    /// Returns the channel that the meter needs in addition to the film's, if it is on: photopic, or with the response of `own`, a channel
    /// of the film.
    pub(crate) fn channel(&self, grid: &Grid, own: Option<&Channel>) -> Option<Channel> {
        let v = v_lambda();
        let photopic = || grid.wavelengths_nm().map(|w| LUMINOUS_EFFICACY_LM_PER_W * v.at(w)).collect();
        (self.metering != Metering::Manual).then(|| Channel {
            name: METER.into(),
            unit: "lx s".into(),
            response: own.map_or_else(photopic, |own| own.response.clone()),
        })
    }

    /// Returns whether the middle of a pixel lies in the metered area.
    pub(crate) fn looks_at(&self, size: &FrameSize, pixel: u32) -> bool {
        match self.metering {
            Metering::Manual => false,
            Metering::Average | Metering::Camera => true,
            Metering::Spot => {
                let (column, row) = (pixel % size.width_px, pixel / size.width_px);
                let x = (f64::from(column) + 0.5) / f64::from(size.width_px) - self.spot.center[0];
                let y = (f64::from(row) + 0.5) / f64::from(size.height_px) - self.spot.center[1];
                let x = x * size.width_mm / size.height_mm;
                x * x + y * y <= 0.25 * self.spot.diameter * self.spot.diameter
            }
        }
    }

    /// Returns the weight of a metered pixel: with `metering: camera` 1 in the middle and a fifth in the corners, otherwise 1.
    fn weight(&self, size: &FrameSize, pixel: u32) -> f64 {
        if self.metering != Metering::Camera {
            return 1.0;
        }
        let along = |at: u32, of: u32| 2.0 * (f64::from(at) + 0.5) / f64::from(of) - 1.0;
        let (x, y) = (along(pixel % size.width_px, size.width_px), along(pixel / size.width_px, size.height_px));
        1.0 / (1.0 + 2.0 * (x * x + y * y))
    }

    /// Returns the factor by which the meter lengthens the exposure; 1 if it is off or sees no light.
    pub(crate) fn factor(&self, exposure: &ExposureFrame) -> f64 {
        if self.metering == Metering::Manual {
            return 1.0;
        }
        let Some(channel) = exposure.channel(METER) else { return 1.0 };
        // Without a limit, lights in the frame would make everything else dark.
        let most = match self.metering {
            Metering::Camera => LIGHTS * median(&channel.values),
            _ => f32::INFINITY,
        };
        let most = if most > 0.0 { most } else { f32::INFINITY };
        let (mut sum, mut all) = (0.0, 0.0);
        // Summed row by row in a fixed order and in double precision, so that the result is the same on any machine.
        for (pixel, value) in (0_u32..).zip(&channel.values) {
            if value.is_finite() && self.looks_at(&exposure.size, pixel) {
                let weight = self.weight(&exposure.size, pixel);
                sum += weight * f64::from(value.min(most));
                all += weight;
            }
        }
        let mean = if all > 0.0 { sum / all } else { 0.0 };
        if mean > 0.0 { self.target_lx_s / mean } else { 1.0 }
    }
}

/// Largest weight of a light in `metering: camera`, as a multiple of the median of the frame.
const LIGHTS: f32 = 8.0;

impl Metering {
    /// The word for this mode in a scene.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Manual => "manual",
            Self::Average => "average",
            Self::Spot => "spot",
            Self::Camera => "camera",
        }
    }
}

/// Returns the median of the finite values; 0 if there are none.
fn median(values: &[f32]) -> f32 {
    let mut all: Vec<f32> = values.iter().copied().filter(|v| v.is_finite()).collect();
    if all.is_empty() {
        return 0.0;
    }
    let middle = all.len() / 2;
    *all.select_nth_unstable_by(middle, f32::total_cmp).1
}
