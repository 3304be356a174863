//! The report `SCENE.json` on how a picture was made.

use crate::header::films;
use crate::job::Job;
use serde_json::{Map, Value, json};
use spectra_core::Loss;
use spectra_render::{GhostPath, LightLedger, Rendering};
use spectra_scene::{FilmTime, FocusBy, Scene};

/// Facts about a finished render.
pub struct Report<'a> {
    pub(crate) job: &'a Job<'a>,
    /// The scene that was rendered.
    pub scene: &'a Scene,
    /// Result of the render.
    pub rendering: &'a Rendering,
    /// Exposure time of each film.
    pub times: &'a [FilmTime],
    /// Duration of tracing, s.
    pub seconds: f64,
    pub(crate) threads: usize,
}

impl Report<'_> {
    /// Returns the rays launched per second of rendering.
    #[must_use]
    pub fn rays_per_second(&self) -> f64 {
        if self.seconds > 0.0 { self.rendering.rays as f64 / self.seconds } else { 0.0 }
    }

    /// Returns the content of `SCENE.json`.
    pub(crate) fn to_json(&self, files: &[String]) -> Value {
        let Self { scene, rendering, .. } = self;
        let settings = &scene.render;
        let size = rendering.exposure.size;
        let channels: Vec<Value> =
            rendering.exposure.channels.iter().map(|c| json!({ "name": c.name, "unit": c.unit })).collect();
        let forward = settings.direction == spectra_scene::Direction::Forward;
        let warnings: Vec<String> =
            scene.warnings.iter().map(ToString::to_string).chain(rendering.warnings.iter().cloned()).collect();
        json!({
            "scene": scene.name,
            "scene_file": self.job.scene_file,
            "overrides": self.job.overrides,
            "files": files,
            "partial": rendering.partial,
            "samples_reached": rendering.samples,
            "seconds": self.seconds,
            "rays": rendering.rays,
            "rays_per_second": self.rays_per_second(),
            "detected": rendering.detected,
            "noise": rendering.noise.map(|n| json!({
                "asked": n.asked, "by_grain": n.by_grain, "median": n.median, "p95": n.p95, "worst": n.worst, "clean": n.clean,
            })),
            "lost": self.lost(),
            "ledger": rendering.ledger.as_ref().map(|ledger| self.ledger(ledger)),
            "ghost_noise": rendering.ghost_noise.map(|n| n.noise),
            "glare": settings.glare.map(|of| json!({
                "share": rendering.glare, "paint": of.paint, "imager": of.imager, "imager_mirror": of.imager_mirror,
            })),
            "diffraction": rendering.diffraction.as_ref().map(|all| all.iter().map(|d| json!({
                "channel": d.channel, "stays_in_pixel": d.stays, "left_frame": d.left, "stars": d.stars,
            })).collect::<Vec<_>>()),
            "seed": settings.seed,
            "direction": match &rendering.estimators[..] {
                all if all.iter().filter(|name| !["ghosts", "glare", "scatter"].contains(name)).count() > 1 => "both",
                _ => settings.direction.name(),
            },
            "samples_per_pixel": (!forward).then_some(settings.samples),
            "batch": settings.batch,
            "threads": self.threads,
            "isa": self.job.isa.name(),
            "width_px": size.width_px,
            "height_px": size.height_px,
            "width_mm": size.width_mm,
            "height_mm": size.height_mm,
            "channels": channels,
            "fingerprint": format!("{:016x}", rendering.exposure.fingerprint()),
            "exposure_time_s": self.exposure_time_s(),
            "metered_time_s": self.film_times_s(|time| Some(time.time_s)),
            "source": scene.source.describe(),
            "focus": focus(scene),
            "lens": { "name": scene.lens.name, "patent": scene.lens.patent, "losses": scene.lens.losses(), "notes": scene.lens.notes },
            "film": films(scene),
            "versions": self.job.versions,
            "warnings": warnings,
            "notes": scene.notes,
        })
    }

    /// Returns the exposure time, s: a number, or one for each film by name if there are several.
    fn exposure_time_s(&self) -> Value {
        if self.times.is_empty() { self.scene.exposure_time_s().into() } else { self.film_times_s(|t| Some(t.time_s)) }
    }

    /// Returns a figure of the films: a number, or one for each film by name if there are several; null if there is no film.
    fn film_times_s(&self, figure: impl Fn(&FilmTime) -> Option<f64>) -> Value {
        let mut by_name = Map::new();
        for time in self.times {
            match &time.name {
                None => return figure(time).into(),
                Some(name) => drop(by_name.insert(name.clone(), figure(time).into())),
            }
        }
        if by_name.is_empty() { Value::Null } else { by_name.into() }
    }

    /// Counts the rays that ended on the way, by cause, and by surface and cause. Surface `null` is not part of the lens:
    /// forward, the ray missed the frame; backward, it ended at the source or missed it.
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

    /// Returns where the light of the source's lights went, W in the band: emitted = detected + lost + not traced.
    fn ledger(&self, ledger: &LightLedger) -> Value {
        let path = |path: &GhostPath| json!({ "surfaces": path.surfaces, "power_w": path.power_w });
        let imager = self.scene.render.reflections;
        json!({
            "order": ledger.order,
            "emitted": ledger.emitted_w,
            "detected": ledger.detected_w(),
            "lost": ledger.lost_w(),
            "not_traced": ledger.not_traced_w,
            "detected_by": { "direct": ledger.direct_w, "ghosts": ledger.ghosts_w },
            "lost_by": {
                "rims": ledger.rims_w,
                "absorbed": ledger.absorbed_w,
                "scattered": ledger.scattered_w,
                "out_of_the_front": ledger.front_w,
                "beside_the_frame": ledger.beside_w,
            },
            "imager_reflectance": { "value": imager.imager, "assumed": !imager.imager_stated },
            "paths": ledger.paths.iter().map(path).collect::<Vec<_>>(),
        })
    }

    /// Returns the first entries of a row of losses, which identify the surface.
    fn surface(&self, number: u32) -> Map<String, Value> {
        let lens = &self.scene.lens;
        let element = (number as usize).checked_sub(1).and_then(|at| lens.elements.get(at));
        let mut row = Map::new();
        row.insert("surface".to_owned(), element.map(|_| number).into());
        let beside = match self.scene.render.direction {
            spectra_scene::Direction::Forward => "imager",
            spectra_scene::Direction::Backward => "source",
        };
        row.insert("kind".to_owned(), element.map_or(beside, |e| e.kind.as_str()).into());
        if let Some(element) = element {
            let (before, after) = (&lens.media[element.medium_before].label, &lens.media[element.medium_after].label);
            row.insert("from".to_owned(), before.as_str().into());
            row.insert("to".to_owned(), after.as_str().into());
        }
        row
    }
}

/// Describes how the lens was focused. A distance of `null` is infinity, or means that the lens was left as in its file.
fn focus(scene: &Scene) -> Value {
    let focus = &scene.focus;
    let per_mm = match focus.by {
        FocusBy::Contrast { per_mm } => Some(per_mm),
        _ => None,
    };
    json!({ "distance_mm": focus.distance_mm, "by": focus.by.name(), "frequency_per_mm": per_mm, "remark": focus.remark })
}
