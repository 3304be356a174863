//! How much noise a picture may have: a fraction of its light, or as much as the grain of its film hides.

use crate::light::Light;
use crate::renderer::Renderer;
use crate::{RenderError, trial};
use spectra_core::frame::{ExposureChannel, ExposureFrame};
use spectra_core::spectral::Channel;
use spectra_core::stage::GrainNoise;
use spectra_scene::NoiseLimit;

/// A block darker than this fraction of the frame's median (four stops) is judged as if it were no darker.
const DARKEST: f64 = 1.0 / 16.0;
/// The noise that is asked for where `auto` finds no grain, as a fraction of the light.
const WITHOUT_GRAIN: f64 = 0.01;
/// Noise of this fraction of the grain's standard deviation makes the picture noisier by a twentieth: the square root of 1 + 1/9.
const OF_GRAIN: f64 = 1.0 / 3.0;
/// Smallest and largest noise that grain asks for. Less than the smallest is not seen without grain either; more than the largest cannot be
/// judged from few samples.
const LEAST: f64 = 0.005;
const MOST: f64 = 0.25;

/// How much noise one channel may have.
#[derive(Clone, Debug)]
pub(crate) enum Tolerance {
    /// This fraction of the light, or of `floor` where there is less light; `None` if the floor is not known before the frame is.
    Fraction { fraction: f64, floor: Option<f64> },
    /// The noise that the grain hides, which depends on the exposure.
    Grain(GrainNoise),
}

impl Tolerance {
    /// Returns the largest standard deviation that a pixel may have where the mean exposure is `mean`, in the unit of the mean.
    pub fn deviation(&self, mean: f64) -> f64 {
        match self {
            Self::Fraction { fraction, .. } => fraction * mean.max(self.floor()),
            Self::Grain(grain) => (OF_GRAIN * grain.at(mean)).clamp(LEAST, MOST) * mean,
        }
    }

    /// Returns the largest standard deviation that a part of the light may have, of which the mean exposure is `mean`, whatever other light
    /// is added. Grain may hide less on the curve's straight part than in its toe.
    pub fn deviation_of_part(&self, mean: f64) -> f64 {
        match self {
            Self::Fraction { .. } => self.deviation(mean),
            Self::Grain(grain) => (OF_GRAIN * grain.least_deviation_from(mean)).clamp(LEAST * mean, MOST * mean),
        }
    }

    /// The exposure below which a block is judged as if it were no darker; 0 if there is none.
    pub fn floor(&self) -> f64 {
        match self {
            Self::Fraction { floor, .. } => floor.unwrap_or(0.0),
            Self::Grain(_) => 0.0,
        }
    }

    /// Returns a copy with a floor that follows from the median of the frame, unless it has one or needs none.
    pub fn with_floor(&self, median: impl FnOnce() -> f64) -> Self {
        match self {
            Self::Fraction { fraction, floor: None } => {
                Self::Fraction { fraction: *fraction, floor: Some(DARKEST * median()) }
            }
            other => other.clone(),
        }
    }

    /// Whether it follows from the grain of a film.
    pub fn is_grain(&self) -> bool {
        matches!(self, Self::Grain(_))
    }
}

impl Renderer {
    /// Returns the tolerance of each judged channel, in the unit of the exposure of the frame. Empty if the scene limits no noise.
    pub(crate) fn tolerances(&self, light: &Light) -> Result<Vec<Tolerance>, RenderError> {
        let scene = self.scene();
        let Some(limit) = scene.render.noise else { return Ok(Vec::new()) };
        let fraction = |fraction: f64, channel: usize| -> Result<Tolerance, RenderError> {
            let floor = self.medians()?.get(channel).map(|median| DARKEST * median * scene.exposure_time_s());
            Ok(Tolerance::Fraction { fraction, floor })
        };
        let judged = self.judged_channels().into_iter();
        let fraction_of_all = match limit {
            NoiseLimit::Fraction(asked) => Some(asked),
            NoiseLimit::Auto if self.keeps_light() => Some(WITHOUT_GRAIN),
            NoiseLimit::Auto => None,
        };
        if let Some(asked) = fraction_of_all {
            return judged.map(|channel| fraction(asked, channel)).collect();
        }
        let metered = self.metered_frame(light);
        let grains: Vec<Option<Vec<GrainNoise>>> =
            scene.films.iter().map(|film| film.film.grain_noise(&film.exposure(&metered))).collect();
        let of_channel = |channel: usize| {
            let number = self.recorded()[channel];
            let of_film = scene.films.iter().zip(&grains).find_map(|(film, grain)| {
                let at = film.channels.clone().position(|own| own == number)?;
                grain.as_ref()?.get(at).cloned()
            });
            of_film.map_or_else(|| fraction(WITHOUT_GRAIN, channel), |grain| Ok(Tolerance::Grain(grain)))
        };
        judged.map(of_channel).collect()
    }

    /// Returns the frame as the meters see it: the other channels have no values.
    fn metered_frame(&self, light: &Light) -> ExposureFrame {
        let (scene, metered) = (self.scene(), light.metered.as_deref().unwrap_or_default());
        let (time_s, meters) = (scene.exposure_time_s(), scene.meter_channels());
        let channel = |(number, channel): (usize, &Channel)| {
            let plane = meters.iter().position(|meter| *meter == number).and_then(|at| metered.get(at));
            let values = plane.into_iter().flatten().map(|value| (value * time_s) as f32).collect();
            ExposureChannel { name: channel.name.clone(), unit: channel.unit.clone(), values }
        };
        let channels = scene.channels.iter().enumerate().map(channel).collect();
        ExposureFrame { size: scene.imager.size(), channels }
    }

    /// Returns the median of the frame in each channel, W/m2, of light of single pixels; empty if there is none. Found once, by a trial
    /// whose random numbers do not depend on the seed.
    fn medians(&self) -> Result<&[f64], RenderError> {
        if let Some(known) = self.known_medians().get() {
            return Ok(known);
        }
        let mut medians: Vec<f64> = Vec::new();
        for part in self.parts().firsts().iter().filter(|part| part.estimator.in_check_pixels().is_some()) {
            let own = trial::medians(self.pipeline(), &*part.estimator)?;
            medians.resize(own.len(), 0.0);
            medians.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        Ok(self.known_medians().get_or_init(|| medians))
    }
}
