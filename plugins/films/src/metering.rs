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

/// The time, s, that light is recorded for: the scene's, or 1 s where the camera meters. The meter's time does not depend on
/// it. And whether a stated time has no effect.
pub(crate) fn recorded_time_s(exposure: Option<Positive<Time>>, metering: Metering) -> (f64, bool) {
    match (exposure, metering) {
        (Some(time), Metering::Manual) => (time.s(), false),
        (stated, _) => (1.0, stated.is_some()),
    }
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

    /// How the film is exposed, where `exposure_time_s` is the scene's time.
    pub(crate) fn words(&self, exposure_time_s: f64) -> String {
        match self.metering {
            Metering::Manual => format!("exposed for {}", shutter::words(exposure_time_s)),
            Metering::Average => "metered (average)".to_owned(),
            Metering::Spot => "metered (spot)".to_owned(),
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
            Metering::Average => true,
            Metering::Spot => {
                let (column, row) = (pixel % size.width_px, pixel / size.width_px);
                let x = (f64::from(column) + 0.5) / f64::from(size.width_px) - self.spot.center[0];
                let y = (f64::from(row) + 0.5) / f64::from(size.height_px) - self.spot.center[1];
                let x = x * size.width_mm / size.height_mm;
                x * x + y * y <= 0.25 * self.spot.diameter * self.spot.diameter
            }
        }
    }

    /// How many times longer the meter wants the frame exposed; 1 where it sees no light.
    pub(crate) fn factor(&self, exposure: &ExposureFrame) -> f64 {
        if self.metering == Metering::Manual {
            return 1.0;
        }
        let Some(channel) = exposure.channel(METER) else { return 1.0 };
        let (mut sum, mut count) = (0.0, 0_u64);
        // Row by row in their order, in double precision: the same on any machine.
        for (pixel, value) in (0_u32..).zip(&channel.values) {
            if value.is_finite() && self.looks_at(&exposure.size, pixel) {
                sum += f64::from(*value);
                count += 1;
            }
        }
        let mean = sum / count.max(1) as f64;
        if mean > 0.0 { self.target_lx_s / mean } else { 1.0 }
    }
}
