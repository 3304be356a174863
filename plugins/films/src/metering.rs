//! How the camera finds its exposure.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::{ExposureFrame, FrameSize};
use spectra_core::params::{Fault, Params, Positive, Time};
use spectra_core::shutter;
use spectra_core::spectral::{Channel, Grid};
use spectra_film::print::metered_exposure_lx_s;
use spectra_spectrum::constants::LUMINOUS_EFFICACY_LM_PER_W;
use spectra_spectrum::v_lambda;

/// The channel that the meter reads: photometric lux-seconds, or those of the film where the stock says so.
pub(crate) const METER: &str = "meter";

/// `metering` as written in a scene.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Metering {
    /// The exposure time is the scene's.
    #[default]
    Manual,
    /// The mean of the frame is taken for a mid gray.
    Average,
    /// The mean of a round spot is.
    Spot,
    /// The mean of the frame is, its middle counted more, and lights no more than eight times the rest.
    Camera,
}

/// `exposure` as written in a scene.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ExposureParams {
    /// For this time, s if bare.
    Time(Positive<Time>),
    /// The camera finds it.
    Metered(MeteredWord),
}

/// The word of `exposure`.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MeteredWord {
    /// The camera finds it.
    Metered,
}

/// What a scene says of how a film is exposed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exposed {
    /// How the camera finds its exposure.
    pub metering: Metering,
    /// A picture that was exposed already is taken as it is.
    pub keeps: bool,
    /// The time, s, that light is recorded for: the scene's, or 1 s where the camera meters. The meter's time does not depend on it.
    pub time_s: f64,
    /// A stated time has no effect.
    pub is_overruled: bool,
}

impl Exposed {
    /// By `exposure` and `metering`, either of which may be left out.
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
                let fault = params.fault("metering", "`exposure: metered` is found by the camera, not by hand");
                return Err(fault.hint("leave `metering` out, or state a time, such as `exposure: 1/125 s`"));
            }
            // How the camera meters is stated, so it meters.
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

/// Which frames of an animation the camera meters.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Metered {
    /// The first one, for all.
    #[default]
    First,
    /// Each by itself.
    Each,
}

/// `spot` as written in a scene.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct SpotParams {
    /// Its center, in shares of the frame's width and height from the upper left corner, each 0 to 1.
    #[serde(default = "center")]
    #[schemars(inner(range(min = 0, max = 1)))]
    pub center: [f64; 2],
    /// Its diameter, in shares of the frame's height, above 0 to 4.
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

/// What is said where an exposure time is stated that the meter overrules.
pub(crate) fn overruled(is_overruled: bool) -> Vec<String> {
    let text = "the camera meters, so `exposure` has no effect; leave one of them out, `metering` or `exposure`";
    if is_overruled { vec![text.to_owned()] } else { Vec::new() }
}

/// A meter, set for a speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Meter {
    metering: Metering,
    spot: SpotParams,
    /// Exposure that what is metered is to get, lx s.
    target_lx_s: f64,
}

impl Meter {
    /// A meter for the speed `speed`, with a compensation in stops.
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
            faults.push(fault.hint("`metering: average`, or another `exposure`"));
        }
        let stops = compensation.unwrap_or(0.0);
        if !faults.is_empty() {
            return Err(faults);
        }
        let target_lx_s = metered_exposure_lx_s(speed) * spectra_core::math::pow(2.0, stops);
        Ok(Self { metering, spot, target_lx_s })
    }

    /// Whether it chooses the exposure time.
    pub(crate) fn is_on(&self) -> bool {
        self.metering != Metering::Manual
    }

    /// The meter in a word; `None` of one that is off.
    pub(crate) fn word(&self) -> Option<&'static str> {
        self.is_on().then(|| self.metering.word())
    }

    /// How the film is exposed, where `exposure_time_s` is the scene's time.
    pub(crate) fn words(&self, exposure_time_s: f64) -> String {
        match self.metering {
            Metering::Manual => format!("exposed for {}", shutter::words(exposure_time_s)),
            metered => format!("metered ({})", metered.word()),
        }
    }

    /// The channel that it needs beside the film's: photopic, or with the response of the film's `own`.
    pub(crate) fn channel(&self, grid: &Grid, own: Option<&Channel>) -> Option<Channel> {
        let v = v_lambda();
        let photopic = || grid.wavelengths_nm().map(|w| LUMINOUS_EFFICACY_LM_PER_W * v.at(w)).collect();
        (self.metering != Metering::Manual).then(|| Channel {
            name: METER.into(),
            unit: "lx s".into(),
            response: own.map_or_else(photopic, |own| own.response.clone()),
        })
    }

    /// Whether the middle of a pixel lies in what is metered.
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

    /// What a pixel that it looks at counts: of a camera, 1 in the middle and a fifth in the corners.
    fn weight(&self, size: &FrameSize, pixel: u32) -> f64 {
        if self.metering != Metering::Camera {
            return 1.0;
        }
        let along = |at: u32, of: u32| 2.0 * (f64::from(at) + 0.5) / f64::from(of) - 1.0;
        let (x, y) = (along(pixel % size.width_px, size.width_px), along(pixel / size.width_px, size.height_px));
        1.0 / (1.0 + 2.0 * (x * x + y * y))
    }

    /// How many times longer the meter wants the frame exposed; 1 where it sees no light.
    pub(crate) fn factor(&self, exposure: &ExposureFrame) -> f64 {
        if self.metering == Metering::Manual {
            return 1.0;
        }
        let Some(channel) = exposure.channel(METER) else { return 1.0 };
        // Lights would make all else dark.
        let most = match self.metering {
            Metering::Camera => LIGHTS * median(&channel.values),
            _ => f32::INFINITY,
        };
        let most = if most > 0.0 { most } else { f32::INFINITY };
        let (mut sum, mut all) = (0.0, 0.0);
        // Row by row in their order, in double precision: the same on any machine.
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

/// A light counts no more than so many times the median of the frame.
const LIGHTS: f32 = 8.0;

impl Metering {
    /// As a scene has it.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Manual => "manual",
            Self::Average => "average",
            Self::Spot => "spot",
            Self::Camera => "camera",
        }
    }
}

/// The median of what is finite; 0 of nothing.
fn median(values: &[f32]) -> f32 {
    let mut all: Vec<f32> = values.iter().copied().filter(|v| v.is_finite()).collect();
    if all.is_empty() {
        return 0.0;
    }
    let middle = all.len() / 2;
    *all.select_nth_unstable_by(middle, f32::total_cmp).1
}
