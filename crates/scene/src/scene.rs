//! A scene, assembled: every stage built, the lens focused and stopped, nothing traced yet.

use crate::Focus;
// A circle with `output.rs`: a scene has its outputs, and each of them writes a picture of its scene.
use crate::Output;
use crate::focus::FocusLight;
use crate::said::Said;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::{ExposureChannel, ExposureFrame, FrameSize};
use spectra_core::math::log10;
use spectra_core::params::{Fault, Params, Warning};
use spectra_core::spectral::{Channel, Grid};
use spectra_core::stage::{Film, Imager, Source, WavelengthSampler};
use spectra_lens::{Lens, StrayMatter};
use std::ops::Range;
use std::sync::Arc;

/// Which way light is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From the source.
    Forward,
    /// From the imager.
    Backward,
}

impl Direction {
    /// As a scene names it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Forward => "forward",
            Self::Backward => "backward",
        }
    }
}

/// Whether the lights of a source are rendered forward while the rest of it is rendered backward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lights {
    /// No: all of the source is rendered one way.
    Same,
    /// Where that pays.
    Auto,
    /// Wherever the source has lights.
    Forward,
}

/// Light that surfaces of the lens reflect on its way to the imager.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reflections {
    /// Reflections on the way: 0 for none, 2 for pairs, 4 for more; `None` for pairs where lights are bright enough to matter.
    pub order: Option<u32>,
    /// Part of the light that the imager itself reflects as a mirror does.
    pub imager: f64,
    /// Whether the scene states that.
    pub imager_stated: bool,
    /// Whether light is polarized by what it passes and is reflected by.
    pub polarized: bool,
    /// How much of the frame the light of a ray is spread over.
    pub spread: GhostSpread,
}

/// How the light of a ray that was reflected lands.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum GhostSpread {
    /// Over the part of the frame that it stands for.
    #[default]
    Footprint,
    /// In the one pixel that it meets.
    None,
}

/// How forward rays are spread over the front of the lens.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum ConePattern {
    /// Independent random points.
    Random,
    /// Equal-area rings.
    Rings,
    /// Low-discrepancy points, mapped neighbors to neighbors.
    #[default]
    Disk,
}

/// How the numbers of one stream of samples lie to each other.
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
    /// Jittered strata, as many as a pixel has samples (forward: as the scene states `samples`).
    Stratified,
}

/// The `render` section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderSettings {
    /// Sense of travel, decided: of all light but perhaps that of [`RenderSettings::lights`].
    pub direction: Direction,
    /// Backward: whether what is bright in the source is rendered forward.
    pub lights: Lights,
    /// Backward: samples a pixel; where noise is asked for, the most.
    pub samples: u32,
    /// Noise at which a part of the picture is clean, as a part of the light: where it is reached, no more samples are traced.
    pub noise: Option<f64>,
    /// Forward: rays in all.
    pub rays: u64,
    /// Whether the scene states them.
    pub rays_stated: bool,
    /// Seed of all numbers: of a frame of an animation its own.
    pub seed: u64,
    /// Number of the frame, where each has numbers of its own.
    pub frame: Option<u64>,
    /// Rays a batch.
    pub batch: usize,
    /// Family of the numbers.
    pub numbers: NumberFamily,
    /// Pattern of the forward cone.
    pub cone: ConePattern,
    /// What reflections are traced.
    pub reflections: Reflections,
    /// What veiling glare is made of, where it is asked for.
    pub glare: Option<StrayMatter>,
    /// Whether the edge of the aperture spreads the light that was summed; `None`: where stars of lights would be seen.
    pub diffraction: Option<bool>,
}

impl RenderSettings {
    /// Whether the same rays are traced, as far as both want as many.
    #[must_use]
    pub fn traces_as(&self, other: &Self) -> bool {
        let free = |settings: &Self| Self { batch: 0, samples: 0, rays: 0, diffraction: None, ..*settings };
        // Forward, so many rays are a sample.
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
    /// What its pictures are called by, where there are several films.
    pub name: Option<String>,
    /// The film.
    pub film: Arc<dyn Film>,
    /// Which channels of the scene are its own.
    pub channels: Range<usize>,
}

impl SceneFilm {
    /// What this film recorded of a frame of the whole scene, its channels under the film's own names.
    #[must_use]
    pub fn exposure(&self, all: &ExposureFrame) -> ExposureFrame {
        let own = all.channels.get(self.channels.clone()).unwrap_or_default();
        let named = own.iter().zip(self.film.channels());
        let channels = named.map(|(plane, channel)| ExposureChannel { name: channel.name, ..plane.clone() }).collect();
        ExposureFrame { size: all.size, channels }
    }
}

/// Light of a mid gray over that of white.
pub const MID_GRAY: f64 = spectra_film::print::MID_GRAY;

/// How long a film was exposed.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmTime {
    /// Name of the film, where there are several.
    pub name: Option<String>,
    /// What it is called, in a few words.
    pub film: String,
    /// Exposure time, s: the meter's, where the camera meters.
    pub time_s: f64,
    /// That over the time that the frame was recorded for.
    pub gain: f64,
    /// Whether the meter chose it.
    pub is_metered: bool,
    /// That meter, in a word; `None` of a stated time, or of one that was metered on another frame.
    pub meter: Option<&'static str>,
    /// The picture was exposed already and is taken as it is.
    pub is_as_taken: bool,
    /// The channels of the scene that are the film's own.
    pub channels: Range<usize>,
}

/// A scene, ready to render. Copies share their stages.
#[derive(Clone)]
pub struct Scene {
    /// Name of its outputs: the file's name without its ending.
    pub name: String,
    /// The scene as written, with overrides applied, for the record.
    pub text: String,
    /// The band.
    pub grid: Grid,
    /// The source.
    pub source: Arc<dyn Source>,
    /// The wavelength strategy.
    pub sampler: Arc<dyn WavelengthSampler>,
    /// The lens, focused and stopped.
    pub lens: Arc<Lens>,
    /// How it was focused.
    pub focus: Focus,
    /// The light that it was focused in, and what is to be said of that.
    pub(crate) focused: (Option<FocusLight>, Vec<Fault>),
    /// What its stages said when they were built.
    pub(crate) said: Said,
    /// The imager.
    pub imager: Arc<dyn Imager>,
    /// The film on it, or several side by side in the same light; none on an imager that records by itself.
    pub films: Vec<SceneFilm>,
    /// What is recorded: the imager's own channels, or those of all films, one film after the other.
    pub channels: Arc<[Channel]>,
    /// How to render.
    pub render: RenderSettings,
    /// What to write.
    pub output: Vec<Arc<dyn Output>>,
    /// What a person should know: a glass off its listed range, and so on.
    pub warnings: Vec<Warning>,
    /// What to bear in mind of the data that it uses, though nothing about the scene is wrong.
    pub notes: Vec<String>,
    /// The scene as it was read, for faults that show once the stages are put together.
    pub params: Params,
}

impl Scene {
    /// Exposure time that multiplies irradiance, s; 1 where none is stated and irradiance itself is recorded.
    #[must_use]
    pub fn exposure_time_s(&self) -> f64 {
        match self.films.first() {
            // Of several films the others' channels hold what their own time is more or less.
            Some(first) => first.film.exposure_time_s(),
            None => self.imager.response().and_then(|own| own.exposure_time_s()).unwrap_or(1.0),
        }
    }

    /// All that is worth knowing though nothing is wrong: of how the lens is set, and of the data.
    pub fn all_notes(&self) -> impl Iterator<Item = &String> {
        self.lens.notes.iter().chain(&self.notes)
    }

    /// The channels that pictures are made of, as numbers into [`Scene::channels`]: not those of a meter.
    #[must_use]
    pub fn picture_channels(&self) -> Vec<usize> {
        if self.films.is_empty() {
            return (0..self.channels.len()).collect();
        }
        let of = |f: &SceneFilm| f.channels.start..(f.channels.start + f.film.picture_channels()).min(f.channels.end);
        self.films.iter().flat_map(of).collect()
    }

    /// The other channels: what the camera's meters see.
    #[must_use]
    pub fn meter_channels(&self) -> Vec<usize> {
        let of = |f: &SceneFilm| (f.channels.start + f.film.picture_channels()).min(f.channels.end)..f.channels.end;
        self.films.iter().flat_map(of).collect()
    }

    /// The pixels that a meter looks at, in their order; none where the exposure is set by hand.
    #[must_use]
    pub fn metered_pixels(&self) -> Vec<u32> {
        let size = self.imager.size();
        let metered: Vec<&SceneFilm> =
            self.films.iter().filter(|f| f.film.picture_channels() < f.channels.len()).collect();
        let is_seen = |pixel: &u32| metered.iter().any(|f| f.film.is_metered_at(&size, *pixel));
        if metered.is_empty() { Vec::new() } else { (0..size.pixels() as u32).filter(is_seen).collect() }
    }

    /// Whether a film takes the picture that is the source as it was exposed already.
    #[must_use]
    pub fn is_as_taken(&self, film: &SceneFilm) -> bool {
        film.film.keeps_exposure() && self.source.is_exposed()
    }

    /// By how many stops more a film is exposed than it would be to the picture as it is, whose mid gray leaves `gray` (lx s, in the time
    /// of the recording) in each channel of the scene; `None` where no meter decides or nothing is known of the gray.
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

    /// How long each film was exposed that is on the imager while the frame `exposure` of the scene is recorded. The
    /// exposure that a film got is that of the frame times its gain.
    #[must_use]
    pub fn film_times(&self, exposure: &ExposureFrame) -> Vec<FilmTime> {
        let time = |film: &SceneFilm| {
            let recorded_s = film.film.exposure_time_s();
            let time_s = match &film.name {
                // A film alone has the frame for itself.
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
                is_as_taken: self.is_as_taken(film),
                channels: film.channels.clone(),
            }
        };
        self.films.iter().map(time).collect()
    }
}
