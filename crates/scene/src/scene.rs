//! An assembled scene: every stage built, the lens focused and stopped down, nothing traced yet.

use crate::Focus;
// A circle with `output.rs`: a scene has outputs, and each output writes a picture of its scene.
use crate::Output;
use crate::build_messages::BuildMessages;
use crate::focus::FocusLight;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::{ExposureChannel, ExposureFrame, FrameSize};
use spectra_core::math::log10;
use spectra_core::params::{Fault, Params, Warning};
use spectra_core::spectral::{Channel, Grid};
use spectra_core::stage::{Film, Imager, Source, WavelengthSampler};
use spectra_optics::Optics;
use spectra_tracer::StrayReflectances;
use std::ops::Range;
use std::sync::Arc;

/// Direction in which light is traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Traced from the source.
    Forward,
    /// Traced from the imager.
    Backward,
}

impl Direction {
    /// Returns the name of the direction in a scene.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Forward => "forward",
            Self::Backward => "backward",
        }
    }
}

/// How the bright lights of a source are rendered while the rest of the source is rendered backward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lights {
    /// All of the source is rendered in one direction.
    Same,
    /// Lights are rendered separately if that reduces noise.
    Auto,
    /// Lights are rendered forward whenever the source has any.
    Forward,
}

/// Settings for light that surfaces of the lens reflect on its way to the imager.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reflections {
    /// Number of reflections on the way: 0 for no ghosts, 2, or up to 4. `None` means 2 if lights are bright enough to matter,
    /// otherwise 0.
    pub order: Option<u32>,
    /// Fraction of the light that the imager reflects like a mirror.
    pub imager: f64,
    /// Whether the scene states the reflectance of the imager.
    pub imager_stated: bool,
    /// Whether the polarization of light is followed through surfaces and reflections.
    pub polarized: bool,
    /// Area of the frame that the light of a ray is spread over.
    pub spread: GhostSpread,
}

/// Area of the frame on which the light of a reflected ray lands.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum GhostSpread {
    /// The part of the frame that the ray represents.
    #[default]
    Footprint,
    /// The one pixel that the ray hits.
    None,
}

/// Pattern in which forward rays fill the front of the lens.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum ConePattern {
    /// Independent random points.
    Random,
    /// Rings of equal area.
    Rings,
    /// Low-discrepancy points, mapped so that neighbors stay neighbors.
    #[default]
    Disk,
}

/// Families of the random numbers for the samples of a pixel.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum NumberFamily {
    /// Owen-scrambled Sobol points.
    #[default]
    Sobol,
    /// A rank-1 lattice, shifted for each pixel.
    Lattice,
    /// Independent random numbers.
    Random,
    /// Jittered strata, one for each sample of a pixel (forward: `samples` of the scene).
    Stratified,
}

/// Resolved values of the `render` section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderSettings {
    /// Direction in which light is traced. [`RenderSettings::lights`] may make an exception for the bright lights of the source.
    pub direction: Direction,
    /// Backward: whether the bright lights of the source are rendered forward.
    pub lights: Lights,
    /// Backward: samples per pixel; with `noise`, the largest number.
    pub samples: u32,
    /// Noise at which parts of the picture get no more samples; `None` if every pixel gets all of them.
    pub noise: Option<NoiseLimit>,
    /// Forward: total number of rays.
    pub rays: u64,
    /// Whether the scene states the number of rays.
    pub rays_stated: bool,
    /// Seed of all random numbers; each frame of an animation has its own.
    pub seed: u64,
    /// Number of the frame, if each frame has random numbers of its own.
    pub frame: Option<u64>,
    /// Number of rays in a batch.
    pub batch: usize,
    /// Family of the random numbers.
    pub numbers: NumberFamily,
    /// Pattern of the forward rays.
    pub cone: ConePattern,
    /// Settings for reflections.
    pub reflections: Reflections,
    /// Causes of veiling glare, if glare is asked for.
    pub glare: Option<StrayReflectances>,
    /// Whether diffraction at the edge of the aperture spreads the light. `None`: only if stars around lights would be visible.
    pub diffraction: Option<bool>,
}

/// How much noise a picture may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoiseLimit {
    /// Standard deviation of a pixel, as a fraction of the mean around it.
    Fraction(f64),
    /// A third of the standard deviation of the film's grain, or 1 % where no grain hides the noise.
    Auto,
}

impl RenderSettings {
    /// Returns whether renders with these settings and with `other` trace the same rays, so that one is the other with more
    /// samples. Batch size and diffraction may differ. For rays traced forward, the numbers of rays must be in proportion to the
    /// samples.
    #[must_use]
    pub fn traces_as(&self, other: &Self) -> bool {
        let free = |settings: &Self| Self { batch: 0, samples: 0, rays: 0, diffraction: None, ..*settings };
        // Forward, this many rays make one sample.
        let share = |s: &Self| u128::from(s.rays);
        let as_many = (self.direction == Direction::Backward && self.lights == Lights::Same)
            || share(self) * u128::from(other.samples) == share(other) * u128::from(self.samples);
        let extends = self.numbers != NumberFamily::Stratified || self.samples == other.samples;
        free(self) == free(other) && as_many && extends
    }
}

/// A film on the imager.
#[derive(Clone)]
pub struct SceneFilm {
    /// Name for the film's pictures, if there are several films.
    pub name: Option<String>,
    /// The film itself.
    pub film: Arc<dyn Film>,
    /// Range of the scene's channels that belong to this film.
    pub channels: Range<usize>,
}

impl SceneFilm {
    /// Returns what this film recorded of a frame of the whole scene, with its channels under the film's own names.
    #[must_use]
    pub fn exposure(&self, all: &ExposureFrame) -> ExposureFrame {
        let own = all.channels.get(self.channels.clone()).unwrap_or_default();
        let named = own.iter().zip(self.film.channels());
        let channels = named.map(|(plane, channel)| ExposureChannel { name: channel.name, ..plane.clone() }).collect();
        ExposureFrame { size: all.size, channels }
    }
}

/// Luminance of a mid gray relative to white.
pub const MID_GRAY: f64 = spectra_film::print::MID_GRAY;

/// The exposure time of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmTime {
    /// Name of the film, if there are several.
    pub name: Option<String>,
    /// Short description of the film.
    pub film: String,
    /// Exposure time, s; chosen by the meter if the camera meters.
    pub time_s: f64,
    /// Exposure time divided by the time for which the frame was recorded.
    pub gain: f64,
    /// Whether the meter chose the time.
    pub is_metered: bool,
    /// Name of the meter, such as `spot`; `None` for a stated time, or one metered on another frame.
    pub meter: Option<&'static str>,
    /// Whether the source is a picture that was already exposed and is used as it is.
    pub is_as_taken: bool,
    /// Range of the scene's channels that belong to this film.
    pub channels: Range<usize>,
}

/// A scene that is ready to render. Clones share their stages.
#[derive(Clone)]
pub struct Scene {
    /// Name of the outputs: the scene's file name without its extension.
    pub name: String,
    /// The scene as written, with overrides applied, for the record.
    pub text: String,
    /// Wavelength grid of the band.
    pub grid: Grid,
    /// The source of light.
    pub source: Arc<dyn Source>,
    /// The sampler of wavelengths.
    pub sampler: Arc<dyn WavelengthSampler>,
    /// The lens, focused and stopped down.
    pub lens: Arc<Optics>,
    /// Record of how the lens was focused.
    pub focus: Focus,
    /// The light that the lens was focused in, and warnings about that.
    pub(crate) focused: (Option<FocusLight>, Vec<Fault>),
    /// Messages of the stages from the time when they were built.
    pub(crate) said: BuildMessages,
    /// The imager behind the lens.
    pub imager: Arc<dyn Imager>,
    /// The film on the imager, or several films side by side in the same light; empty for an imager that records by itself.
    pub films: Vec<SceneFilm>,
    /// Recorded channels: the imager's own, or those of all films, one film after another.
    pub channels: Arc<[Channel]>,
    /// Settings of the render.
    pub render: RenderSettings,
    /// Outputs to write.
    pub output: Vec<Arc<dyn Output>>,
    /// Warnings, for example about a glass used outside its measured range.
    pub warnings: Vec<Warning>,
    /// Notes on the data that the scene uses; they are not about faults of the scene.
    pub notes: Vec<String>,
    /// The scene as it was read, to place faults that show once the stages are put together.
    pub params: Params,
}

impl Scene {
    /// Returns the exposure time that multiplies irradiance, s; 1 if none is stated and irradiance itself is recorded.
    #[must_use]
    pub fn exposure_time_s(&self) -> f64 {
        match self.films.first() {
            // The channels of other films include the ratio of their time to this one.
            Some(first) => first.film.exposure_time_s(),
            None => self.imager.response().and_then(|own| own.exposure_time_s()).unwrap_or(1.0),
        }
    }

    /// Iterates over all notes: on how the lens is set, and on the data.
    pub fn all_notes(&self) -> impl Iterator<Item = &String> {
        self.lens.notes.iter().chain(&self.notes)
    }

    /// Returns the indices in [`Scene::channels`] of the channels that make pictures, without those of meters.
    #[must_use]
    pub fn picture_channels(&self) -> Vec<usize> {
        if self.films.is_empty() {
            return (0..self.channels.len()).collect();
        }
        let of = |f: &SceneFilm| f.channels.start..(f.channels.start + f.film.picture_channels()).min(f.channels.end);
        self.films.iter().flat_map(of).collect()
    }

    /// Returns the indices in [`Scene::channels`] of the channels that the camera's meters see.
    #[must_use]
    pub fn meter_channels(&self) -> Vec<usize> {
        let of = |f: &SceneFilm| (f.channels.start + f.film.picture_channels()).min(f.channels.end)..f.channels.end;
        self.films.iter().flat_map(of).collect()
    }

    /// Returns the pixels that a meter looks at, in their order; empty if the exposure is set by hand.
    #[must_use]
    pub fn metered_pixels(&self) -> Vec<u32> {
        let size = self.imager.size();
        let metered: Vec<&SceneFilm> =
            self.films.iter().filter(|f| f.film.picture_channels() < f.channels.len()).collect();
        let is_seen = |pixel: &u32| metered.iter().any(|f| f.film.is_metered_at(&size, *pixel));
        if metered.is_empty() { Vec::new() } else { (0..size.pixels() as u32).filter(is_seen).collect() }
    }

    /// Returns whether a film uses the source picture as it was already exposed.
    #[must_use]
    pub fn uses_source_exposure(&self, film: &SceneFilm) -> bool {
        film.film.keeps_exposure() && self.source.is_exposed()
    }

    /// Returns how many stops more light a film gets than if the source picture were used with the exposure that it was taken
    /// with. `time` is the metered time. `gray` is the exposure of each channel of the scene by the picture's mid gray, lx s, for
    /// the time of the recording.
    ///
    /// `None` if no meter decides the exposure, or if the gray is not known.
    #[must_use]
    pub fn stops_over_file(&self, film: usize, time: &FilmTime, gray: &[f32]) -> Option<f64> {
        let SceneFilm { film, channels, .. } = self.films.get(film)?;
        time.meter?;
        let size = FrameSize { width_px: 1, height_px: 1, width_mm: 1.0, height_mm: 1.0 };
        let plane = |(channel, gray): (Channel, &f32)| ExposureChannel {
            name: channel.name,
            unit: channel.unit,
            values: vec![*gray],
        };
        let card = film.channels().into_iter().zip(gray.get(channels.clone())?).map(plane).collect();
        let as_it_is_s = film.metered_time_s(&ExposureFrame { size, channels: card });
        Some(log10(time.time_s / as_it_is_s) / log10(2.0)).filter(|stops| stops.is_finite())
    }

    /// Returns the exposure time of each film for the recorded frame `exposure` of the scene. To get the exposure of a film,
    /// multiply its channels of the frame by [`FilmTime::gain`].
    #[must_use]
    pub fn film_times(&self, exposure: &ExposureFrame) -> Vec<FilmTime> {
        let time = |film: &SceneFilm| {
            let recorded_s = film.film.exposure_time_s();
            let time_s = match &film.name {
                // A single film owns the whole frame.
                None => film.film.metered_time_s(exposure),
                Some(_) => film.film.metered_time_s(&film.exposure(exposure)),
            };
            FilmTime {
                name: film.name.clone(),
                film: film.film.name(),
                time_s,
                gain: time_s / recorded_s,
                is_metered: film.film.is_metered() || time_s != recorded_s,
                meter: film.film.meter(),
                is_as_taken: self.uses_source_exposure(film),
                channels: film.channels.clone(),
            }
        };
        self.films.iter().map(time).collect()
    }
}
