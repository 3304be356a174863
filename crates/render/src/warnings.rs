//! Warnings about a picture: no light on it, too much light, or too few rays.

use crate::forward;
use crate::light::Light;
use crate::noise::Noise;
use crate::renderer::Renderer;
use crate::rendering::Rendering;
use spectra_core::frame::ExposureFrame;
use spectra_core::{Loss, LossCounts, shutter};
use spectra_scene::{Direction, Scene, SceneFilm};

/// If at least this fraction of the lit pixels is isolated or beside holes, there are too few rays, and the picture is not black there.
const SPARSE: f64 = 0.5;
/// Number of expected rays per pixel above which hardly any pixel stays empty by chance: one in 3000 gets none at this number.
const FEW_RAYS: f64 = 8.0;
/// Fraction of clean blocks above which no warning about noise is given.
const CLEAN: f64 = 0.99;

/// One part in this many of the frame may be a light rather than the subject of the picture.
const DAZZLING: usize = 100;
/// Ratio of the mean with and without the lights above which a meter follows the lights alone: six stops.
const DAZZLED: f64 = 64.0;
/// Shortest exposure time of most cameras, s. If a meter asks for less, a smaller ratio is enough for a warning.
const SHUTTER_S: f64 = 1.0 / 8000.0;
/// Ratio of the mean with and without the lights that is enough for a warning if the exposure time is too short: two stops.
const DAZZLED_SHORT: f64 = 4.0;

impl Renderer {
    /// Returns the warnings that a person should read before believing a rendering of this light.
    #[must_use]
    pub fn warnings(&self, light: &Light, rendering: &Rendering) -> Vec<String> {
        collect_warnings(self, light, rendering)
    }
}

fn collect_warnings(renderer: &Renderer, light: &Light, rendering: &Rendering) -> Vec<String> {
    let scene = renderer.scene();
    let mut all = Vec::new();
    if rendering.detected == 0 {
        // A render that stopped before its first ray gives no information.
        if rendering.rays > 0 {
            all.push(nothing_seen(renderer, rendering));
        }
        return all;
    }
    all.extend(scene.films.iter().filter_map(|film| blind_meter(film, &rendering.exposure)));
    all.extend(scene.films.iter().filter_map(|film| dazzled_meter(film, &rendering.exposure)));
    all.extend(rendering.noise.filter(|_| !rendering.partial).and_then(|noise| still_noisy(scene, &noise)));
    let planes = &rendering.exposure.channels;
    let pixels = rendering.exposure.size.pixels();
    let infinite = (0..pixels).filter(|p| planes.iter().any(|plane| !plane.values[*p].is_finite())).count();
    if infinite > 0 {
        all.push(format!(
            "{infinite} of {pixels} pixels have more light than a 32-bit float can hold (3.4e38) and are infinite; use less \
             luminance or a shorter exposure"
        ));
    } else if planes.iter().all(|plane| plane.values.iter().all(|value| *value == 0.0)) {
        all.push(
            "all pixels are 0: light arrived, but less than a 32-bit float can hold (1.4e-45); use more luminance, a \
             larger source or a longer exposure"
                .to_owned(),
        );
    } else if scene.render.direction == Direction::Forward && !scene.films.is_empty() {
        all.extend(sparse(renderer, light));
    }
    all
}

/// Warns if the largest number of samples was not enough for the requested noise.
fn still_noisy(scene: &Scene, noise: &Noise) -> Option<String> {
    (noise.clean < CLEAN).then(|| {
        format!(
            "{:.0} % of the frame is noisier than the requested {} (worst block {}); raise `render.samples` (now {})",
            100.0 * (1.0 - noise.clean),
            percent(noise.asked),
            percent(noise.worst),
            scene.render.samples
        )
    })
}

/// Formats a fraction as a percentage with two digits, as in `1.4 %`.
#[must_use]
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent < 10.0 { format!("{percent:.1} %") } else { format!("{percent:.0} %") }
}

/// Warns about a meter that sees no light and therefore cannot choose an exposure time.
fn blind_meter(film: &SceneFilm, exposure: &ExposureFrame) -> Option<String> {
    let planes = exposure.channels.get(film.channels.clone())?.get(film.film.picture_channels()..)?;
    let is_blind = !planes.is_empty() && planes.iter().all(|plane| plane.values.iter().all(|value| *value == 0.0));
    let named = film.name.as_ref().map_or_else(String::new, |name| format!("{name}: "));
    is_blind.then(|| {
        format!(
            "{named}the camera's meter sees no light where it looks, so the film is exposed for {}; write `exposure` \
             instead of `metering`, or meter another part of the frame",
            shutter::format_time(film.film.metered_time_s(exposure))
        )
    })
}

/// Warns if a sun or a lamp in the frame outshines the subject and dominates the mean of a meter.
fn dazzled_meter(film: &SceneFilm, exposure: &ExposureFrame) -> Option<String> {
    let plane = exposure.channels.get(film.channels.clone())?.get(film.film.picture_channels()..)?.first()?;
    if !film.film.is_metered() || plane.values.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let seen = |(pixel, value): (u32, &f32)| film.film.is_metered_at(&exposure.size, pixel).then_some(*value);
    let mut values: Vec<f32> = (0_u32..).zip(&plane.values).filter_map(seen).collect();
    let few = values.len() / DAZZLING;
    if few == 0 {
        return None;
    }
    values.sort_unstable_by(f32::total_cmp);
    let mean = |values: &[f32]| values.iter().map(|value| f64::from(*value)).sum::<f64>() / values.len() as f64;
    let brighter = mean(&values) / mean(&values[..values.len() - few]);
    let time_s = film.film.metered_time_s(exposure);
    let is_short = time_s < SHUTTER_S && brighter > DAZZLED_SHORT;
    if !(is_short || brighter > DAZZLED) || !brighter.is_finite() {
        return None;
    }
    let named = film.name.as_ref().map_or_else(String::new, |name| format!("{name}: "));
    Some(format!(
        "{named}the brightest hundredth of what the camera's meter sees sets the exposure ({}) and makes the rest of the picture \
         {:.0} stops too dark; write `exposure: {}` instead of `metering` to expose for the rest",
        shutter::format_time(time_s),
        spectra_core::math::log2(brighter),
        shutter::format_time(time_s * brighter)
    ))
}

/// Warns if empty pixels lie between pixels that rays reached: film is not a mean, it develops empty pixels as unexposed. Looks only at the
/// light that `render.rays` trace, because ghosts and glare get theirs by `samples`.
fn sparse(renderer: &Renderer, light: &Light) -> Option<String> {
    let scene = renderer.scene();
    let size = scene.imager.size();
    let (width, height) = (size.width_px as usize, size.height_px as usize);
    let mut reached = vec![0.0; width * height];
    let mut rays = 0;
    let parts = renderer.estimators().zip(&light.parts).filter(|(estimator, _)| estimator.name() == forward::ESTIMATOR);
    for (_, part) in parts {
        let channels = renderer.recorded().len();
        let of = |p: usize| (0..channels).map(|at| part.sums.get(p * channels + at) as f64).sum::<f64>();
        reached.iter_mut().enumerate().for_each(|(p, sum)| *sum += of(p));
        rays += part.detected;
    }
    // The light of this many average rays: a pixel with more was not reached by chance.
    let few = FEW_RAYS * reached.iter().sum::<f64>() / rays as f64;
    let lit: Vec<bool> = reached.iter().map(|sum| *sum != 0.0).collect();
    let around = |p: usize| {
        let (column, row) = (p % width, p / width);
        let columns = column.saturating_sub(1)..(column + 2).min(width);
        let rows = row.saturating_sub(1)..(row + 2).min(height);
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column)).filter(move |at| *at != p)
    };
    let lit_around = |p: usize| around(p).filter(|at| lit[*at]).count();
    // Isolated, or beside a hole: the edge of a small spot is neither.
    let is_ragged = |p: usize| {
        let beside_empty = around(p).any(|at| !lit[at]);
        beside_empty && (lit_around(p) < 3 || around(p).any(|at| !lit[at] && lit_around(at) > 3))
    };
    let many = lit.iter().filter(|lit| **lit).count();
    let edge = (0..lit.len()).filter(|p| lit[*p] && reached[*p] < few && is_ragged(*p)).count();
    let empty = lit.len() - many;
    if many == 0 || (edge as f64) < SPARSE * many as f64 || empty * 10 < lit.len() {
        return None;
    }
    let can_backward = scene.source.radiance().is_some() && scene.imager.launch().is_some();
    let instead = if can_backward { ", or write `render.direction: backward`" } else { "" };
    Some(format!(
        "{:.0} % of the pixels got no ray, many of them next to pixels that did; film shows them as unexposed, so the picture is too dark; \
         raise `render.rays` (now {}){instead}",
        100.0 * empty as f64 / lit.len() as f64,
        scene.render.rays
    ))
}

/// Explains why the frame is empty and what to change.
fn nothing_seen(renderer: &Renderer, rendering: &Rendering) -> String {
    let scene = renderer.scene();
    let landing = renderer.landing();
    let beside = landing.filter(|landing| landing.on_frame == 0.0);
    if let Some(landing) = beside {
        let size = rendering.exposure.size;
        let [x, y] = landing.middle_mm.map(|mm| format!("{mm:.1} mm"));
        return format!(
            "no light reaches the frame: it lands around x = {x}, y = {y} in the image plane, outside the recorded {} x {} mm; \
             write `imager.shift: [{x}, {y}]` to record it",
            size.width_mm, size.height_mm
        );
    }
    let why = chief_loss(&rendering.losses);
    match (scene.render.direction, landing) {
        (Direction::Backward, _) if rendering.losses.of_cause(Loss::Unlit) > 0 => {
            "no light reaches the frame: everything in view is black or outside the picture; make the `source` larger or move it closer"
                .to_owned()
        }
        (Direction::Forward, Some(_)) => {
            "no light reaches the frame: none of the traced rays hit it; try more `render.rays`".to_owned()
        }
        _ => format!(
            "no light reaches the frame: nothing passes the lens{why}; `spectra lens draw` shows what blocks it"
        ),
    }
}

/// Describes where most rays end; empty if that is not at a surface of the lens.
fn chief_loss(losses: &LossCounts) -> String {
    let most = losses.iter().max_by_key(|(_, _, rays)| *rays);
    most.filter(|(surface, _, _)| *surface > 0).map_or(String::new(), |(surface, cause, _)| {
        format!(", most rays end at surface {surface} ({})", cause.name().replace('_', " "))
    })
}
