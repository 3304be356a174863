//! `render.json`: how a picture came about.

use super::direction;
use super::picture::films;
use crate::arguments::Run;
use crate::version;
use serde_json::{Map, Value, json};
use spectra_core::{Isa, Loss};
use spectra_render::Rendering;
use spectra_scene::Scene;
use std::path::PathBuf;

/// All there is to say of a render.
pub(crate) struct Report<'a> {
    pub scene: &'a Scene,
    pub arguments: &'a Run,
    pub rendering: &'a Rendering,
    pub seconds: f64,
    pub threads: usize,
    pub isa: Isa,
    /// What the header of the EXR says beside what it says of every picture: names and texts.
    pub attributes: &'a [(String, String)],
}

impl Report<'_> {
    /// Rays launched per second of rendering.
    pub(crate) fn rays_per_second(&self) -> f64 {
        if self.seconds > 0.0 { self.rendering.rays as f64 / self.seconds } else { 0.0 }
    }

    /// The content of `render.json`.
    pub(crate) fn to_json(&self, files: &[PathBuf]) -> Value {
        let Self { scene, rendering, .. } = self;
        let settings = &scene.render;
        let size = rendering.exposure.size;
        let channels: Vec<Value> =
            rendering.exposure.channels.iter().map(|c| json!({ "name": c.name, "unit": c.unit })).collect();
        let forward = settings.direction == spectra_scene::Direction::Forward;
        json!({
            "scene": scene.name,
            "scene_file": self.arguments.scene.display().to_string(),
            "overrides": super::overrides(self.arguments),
            "files": files.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
            "partial": rendering.partial,
            "seconds": self.seconds,
            "rays": rendering.rays,
            "rays_per_second": self.rays_per_second(),
            "lost": self.lost(),
            "seed": settings.seed,
            "direction": direction(scene),
            "samples_per_pixel": (!forward).then_some(settings.samples),
            "batch": settings.batch,
            "threads": self.threads,
            "isa": self.isa.name(),
            "width_px": size.width_px,
            "height_px": size.height_px,
            "width_mm": size.width_mm,
            "height_mm": size.height_mm,
            "channels": channels,
            "exposure_time_s": scene.exposure_time_s(),
            "metered_time_s": self.metered_times_s(),
            "source": scene.source.describe(),
            "lens": { "name": scene.lens.name, "patent": scene.lens.patent },
            "film": films(scene),
            "versions": version::to_json(),
            "warnings": scene.warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        })
    }

    /// What the camera's meter chose: a number, of several films one each by their names.
    fn metered_times_s(&self) -> Value {
        let exposure = &self.rendering.exposure;
        let mut by_name = Map::new();
        for film in &self.scene.films {
            match &film.name {
                None => return film.film.metered_time_s(exposure).into(),
                Some(name) => {
                    by_name.insert(name.clone(), film.film.metered_time_s(&film.exposure(exposure)).into());
                }
            }
        }
        if by_name.is_empty() { Value::Null } else { by_name.into() }
    }

    /// Rays that ended on the way, by cause, and by surface with its causes. A surface number of `null` is none of the
    /// lens's: beside the frame.
    fn lost(&self) -> Value {
        let losses = &self.rendering.losses;
        let by_cause: Map<String, Value> =
            Loss::ALL.iter().map(|c| (c.name().to_owned(), losses.of_cause(*c).into())).collect();
        let mut by_surface: Vec<Map<String, Value>> = Vec::new();
        let mut last = None;
        for (surface, cause, rays) in losses.iter() {
            if last != Some(surface) {
                last = Some(surface);
                by_surface.push(self.surface(surface));
            }
            if let Some(row) = by_surface.last_mut() {
                row.insert(cause.name().to_owned(), rays.into());
            }
        }
        json!({ "total": losses.total(), "by_cause": by_cause, "by_surface": by_surface })
    }

    /// The head of a row of losses: which surface.
    fn surface(&self, number: u32) -> Map<String, Value> {
        let lens = &self.scene.lens;
        let element = (number as usize).checked_sub(1).and_then(|at| lens.elements.get(at));
        let mut row = Map::new();
        row.insert("surface".to_owned(), element.map(|_| number).into());
        row.insert("kind".to_owned(), element.map_or("imager", |e| e.kind.as_str()).into());
        if let Some(element) = element {
            let (before, after) = (&lens.media[element.medium_before].label, &lens.media[element.medium_after].label);
            row.insert("from".to_owned(), before.as_str().into());
            row.insert("to".to_owned(), after.as_str().into());
        }
        row
    }
}
