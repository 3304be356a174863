//! Small pictures of bundled scenes.

use super::plane::Plane;
use crate::common::repository;
use spectra_core::Isa;
use spectra_plugins as _;
use spectra_render::{Control, Effort, GhostRays, RenderOptions, Renderer, Rendering, SingleThread, Traced};
use spectra_scene::{Developed, LightKind, Scene, Shot, ViewSearch, load_series};
use std::sync::{Arc, OnceLock};

/// Selects a picture of a scene and the part of its light to render.
pub struct Take {
    index: usize,
    set: &'static [&'static str],
    /// Rays of the ghosts; if given, only ghosts are rendered.
    ghosts: Option<GhostRays>,
}

/// Selects the first picture of a scene, with values `path=value` on top that make it small.
pub const fn first(set: &'static [&'static str]) -> Take {
    member(0, set)
}

/// Selects a picture by its index in the scene's series, from 0.
pub const fn member(index: usize, set: &'static [&'static str]) -> Take {
    Take { index, set, ghosts: None }
}

/// Selects only the ghosts of a picture.
pub const fn ghosts(index: usize, set: &'static [&'static str], rays: GhostRays) -> Take {
    Take { index, set, ghosts: Some(rays) }
}

/// A rendered picture of a scene.
pub struct Taken {
    pub scene: Arc<Scene>,
    pub rendering: Rendering,
    /// The developed films, made on first use.
    films: OnceLock<Vec<Developed>>,
    /// Messages of all warnings.
    pub said: Vec<String>,
}

impl Taken {
    /// Renders a picture. The pupil search is that of a draft, which is unbiased and takes a tenth of the time.
    pub fn of(name: &str, take: &Take) -> Self {
        let path = repository(&format!("scenes/{name}.yaml"));
        let set: Vec<String> = take.set.iter().map(|text| (*text).to_owned()).collect();
        let series = load_series(&path, &set).unwrap_or_else(|faults| panic!("{name}: {faults}"));
        let search = ViewSearch { effort: Effort::Draft, workers: &SingleThread };
        let scene = series.scene_between(take.index, None, None, search);
        let scene = Arc::new(scene.unwrap_or_else(|faults| panic!("{name}: {faults}")));
        let (isa, shared) = (Isa::detect(), Arc::clone(&scene));
        let renderer = match take.ghosts {
            Some(rays) => {
                Renderer::new(shared, &RenderOptions { isa, traced: Traced::Ghosts(rays), ..RenderOptions::default() })
            }
            None => Renderer::new(shared, &RenderOptions { isa, effort: Effort::Draft, ..RenderOptions::default() }),
        };
        let renderer = renderer.unwrap_or_else(|error| panic!("{name}: {error}"));
        let rendering = renderer.run(&SingleThread, &Control::new()).unwrap_or_else(|error| panic!("{name}: {error}"));
        let warnings = series.warnings().iter().chain(&scene.warnings).chain(scene.source.warnings());
        let mut said: Vec<String> = warnings.map(|warning| warning.0.message.clone()).collect();
        if take.ghosts.is_none() {
            said.extend(rendering.warnings.iter().cloned());
            let beyond =
                scene.films.iter().filter_map(|film| film.film.misexposure(&film.exposure(&rendering.exposure)));
            said.extend(beyond.map(|beyond| format!("nearly the whole film is {beyond:?}")));
        }
        Self { scene, rendering, films: OnceLock::new(), said }
    }

    fn plane(&self, values: &[f32]) -> Plane {
        Plane::new(self.rendering.exposure.size, values.iter().map(|value| f64::from(*value)).collect())
    }

    /// Returns the light of a channel by its name.
    pub fn channel(&self, name: &str) -> Plane {
        let channel = self.rendering.exposure.channel(name).unwrap_or_else(|| panic!("no channel {name}"));
        self.plane(&channel.values)
    }

    /// Returns the sum of the light of all channels that make up the picture.
    pub fn light(&self) -> Plane {
        let all = self.channels().into_iter().map(|(plane, _)| plane);
        all.reduce(|sum, plane| sum.with(&plane, |a, b| a + b)).expect("it records something")
    }

    /// Returns the light of one kind, summed over all channels. An output of the scene must contain that kind.
    pub fn layer(&self, kind: LightKind) -> Plane {
        let layer = self.rendering.layers.iter().find(|layer| layer.kind == kind).expect("an output holds it");
        let all = layer.channels.iter().map(|channel| self.plane(&channel.values));
        all.reduce(|sum, plane| sum.with(&plane, |a, b| a + b)).expect("it has channels")
    }

    /// Returns the light of each channel that makes up the picture, with its response.
    pub fn channels(&self) -> Vec<(Plane, &[f64])> {
        let one = |at: usize| (self.channel(&self.scene.channels[at].name), &self.scene.channels[at].response[..]);
        self.scene.picture_channels().into_iter().map(one).collect()
    }

    /// Returns the finished picture on one of the films: red, green and blue light of the screen, where 1 is its white.
    pub fn colors(&self, film: usize) -> [Plane; 3] {
        let films = self.films.get_or_init(|| {
            let times = self.scene.film_times(&self.rendering.exposure);
            let shot = Shot::new(&self.scene, &self.rendering.exposure, &times, &[], Isa::detect());
            shot.pictures().expect("it is developed").to_vec()
        });
        let rgb = &films[film].1.rgb;
        [0, 1, 2].map(|k| self.plane(&rgb.iter().map(|v| v[k].clamp(0.0, 1.0)).collect::<Vec<_>>()))
    }

    /// Returns the luminance of the finished picture on one of the films.
    pub fn tones(&self, film: usize) -> Plane {
        let [red, green, blue] = self.colors(film);
        red.with(&green, |r, g| 0.2126 * r + 0.7152 * g).with(&blue, |a, b| a + 0.0722 * b)
    }

    /// Returns image size over object size for a flat object at this distance from the first vertex.
    pub fn magnification(&self, distance_mm: f64) -> f64 {
        let first_order = self.scene.lens.first_order(self.scene.lens.reference_nm);
        first_order.efl_mm / (distance_mm + first_order.ffl_mm)
    }

    /// Returns the diameter of the aperture, mm: focal length over f-number.
    pub fn opening_mm(&self) -> f64 {
        let lens = &self.scene.lens;
        lens.first_order(lens.reference_nm).efl_mm / lens.marginal_ray().expect("the lens has sizes").f_number()
    }

    /// Returns the blur diameter, mm, of a point at a distance if the lens is focused at another distance. It is aperture times
    /// magnification times the difference of the distances over the distance of the point.
    pub fn blur_mm(&self, focus_mm: f64, distance_mm: f64) -> f64 {
        self.opening_mm() * self.magnification(focus_mm) * (distance_mm - focus_mm).abs() / distance_mm
    }
}
