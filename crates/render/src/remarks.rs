//! What a person should know of a picture before believing it: nothing on it, too much on it, too little of it.

use crate::{Noise, Renderer, Rendering};
use spectra_core::frame::ExposureFrame;
use spectra_core::{Loss, LossCounts, shutter};
use spectra_scene::{Direction, Scene, SceneFilm};

/// Of the lit pixels, this share beside empty ones tells that rays are too few, and not that the picture is black there.
const SPARSE: f64 = 0.5;
/// What is clean almost everywhere is not worth a word.
const CLEAN: f64 = 0.99;

/// What is to be said of a rendering.
pub(crate) fn remarks(renderer: &Renderer, rendering: &Rendering) -> Vec<String> {
    let scene = renderer.scene();
    let mut all = Vec::new();
    if rendering.detected == 0 {
        // Stopped before its first ray, it tells nothing.
        if rendering.rays > 0 {
            all.push(nothing_seen(renderer, rendering));
        }
        return all;
    }
    all.extend(scene.films.iter().filter_map(|film| blind_meter(film, &rendering.exposure)));
    all.extend(rendering.noise.filter(|_| !rendering.partial).and_then(|noise| still_noisy(scene, &noise)));
    let planes = &rendering.exposure.channels;
    let pixels = rendering.exposure.size.pixels();
    let infinite = (0..pixels).filter(|p| planes.iter().any(|plane| !plane.values[*p].is_finite())).count();
    if infinite > 0 {
        all.push(format!(
            "{infinite} of {pixels} pixels have more light than a 32-bit float can hold (3.4e38): they are infinite; less \
             luminance or a shorter exposure keeps them finite"
        ));
    } else if planes.iter().all(|plane| plane.values.iter().all(|value| *value == 0.0)) {
        all.push(
            "all pixels are 0: light arrived, but less than a 32-bit float can hold (1.4e-45); more luminance, a larger \
             source or a longer exposure shows it"
                .to_owned(),
        );
    } else if scene.render.direction == Direction::Forward && !scene.films.is_empty() {
        all.extend(sparse(scene, &rendering.exposure));
    }
    all
}

/// The most samples did not suffice.
fn still_noisy(scene: &Scene, noise: &Noise) -> Option<String> {
    (noise.clean < CLEAN).then(|| {
        format!(
            "{:.0} % of the frame has more noise than the {} that was asked for, up to {}: `render.samples` (now {}) was the \
             limit, more of them go on",
            100.0 * (1.0 - noise.clean),
            percent(noise.asked),
            percent(noise.worst),
            scene.render.samples
        )
    })
}

/// A share to two digits: `1.4 %`.
#[must_use]
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent < 10.0 { format!("{percent:.1} %") } else { format!("{percent:.0} %") }
}

/// A meter that sees no light cannot choose a time.
fn blind_meter(film: &SceneFilm, exposure: &ExposureFrame) -> Option<String> {
    let planes = exposure.channels.get(film.channels.clone())?.get(film.film.picture_channels()..)?;
    let is_blind = !planes.is_empty() && planes.iter().all(|plane| plane.values.iter().all(|value| *value == 0.0));
    let named = film.name.as_ref().map_or_else(String::new, |name| format!("{name}: "));
    is_blind.then(|| {
        format!(
            "{named}the camera's meter sees no light where it looks, so the film is exposed for {}; state `exposure` in \
             place of `metering`, or meter another part of the frame",
            shutter::words(film.film.metered_time_s(exposure))
        )
    })
}

/// Film is no mean: what no ray reached is developed as unexposed, between pixels that rays did reach.
fn sparse(scene: &Scene, exposure: &ExposureFrame) -> Option<String> {
    let (width, height) = (exposure.size.width_px as usize, exposure.size.height_px as usize);
    let lit: Vec<bool> = (0..width * height).map(|p| exposure.channels.iter().any(|c| c.values[p] != 0.0)).collect();
    let beside_empty = |p: usize| {
        let (column, row) = (p % width, p / width);
        let columns = column.saturating_sub(1)..=(column + 1).min(width - 1);
        let mut rows = row.saturating_sub(1)..=(row + 1).min(height - 1);
        rows.any(|row| columns.clone().any(|column| !lit[row * width + column]))
    };
    let many = lit.iter().filter(|lit| **lit).count();
    let edge = (0..lit.len()).filter(|p| lit[*p] && beside_empty(*p)).count();
    let empty = lit.len() - many;
    if many == 0 || (edge as f64) < SPARSE * many as f64 || empty * 10 < lit.len() {
        return None;
    }
    let can_backward = scene.source.radiance().is_some() && scene.imager.launch().is_some();
    let instead = if can_backward { ", or `render.direction: backward`" } else { "" };
    Some(format!(
        "{:.0} % of the pixels got no ray, many of them among pixels that did: film shows them as unexposed, too dark overall; more `render.rays` (now {}){instead} fills them",
        100.0 * empty as f64 / lit.len() as f64,
        scene.render.rays
    ))
}

/// Why the frame is empty, and what would see the light.
fn nothing_seen(renderer: &Renderer, rendering: &Rendering) -> String {
    let scene = renderer.scene();
    let landing = renderer.landing();
    let beside = landing.filter(|landing| landing.on_frame == 0.0);
    if let Some(landing) = beside {
        let size = rendering.exposure.size;
        let [x, y] = landing.middle_mm.map(|mm| format!("{mm:.1} mm"));
        return format!(
            "no light reaches the frame: it lands around x = {x}, y = {y} of the image plane, beside the {} x {} mm that are \
             recorded; `imager.shift: [{x}, {y}]` would catch it",
            size.width_mm, size.height_mm
        );
    }
    let why = chief_loss(&rendering.losses);
    match (scene.render.direction, landing) {
        (Direction::Backward, _) if rendering.losses.of_cause(Loss::Unlit) > 0 => {
            "no light reaches the frame: everything in view is beside the picture, or black; make the `source` larger or move it closer"
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

/// Where most rays end, in words.
fn chief_loss(losses: &LossCounts) -> String {
    let most = losses.iter().max_by_key(|(_, _, rays)| *rays);
    most.filter(|(surface, _, _)| *surface > 0).map_or(String::new(), |(surface, cause, _)| {
        format!(", most rays end at surface {surface} ({})", cause.name().replace('_', " "))
    })
}
