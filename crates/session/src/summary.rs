//! The summary of a finished picture, in a photographer's words.

use crate::{LightFrom, Report, formatting};
use spectra_core::math::log10;
use spectra_core::params::{Node, Value};
use spectra_core::{Loss, shutter};
use spectra_darkroom::is_picture;
use spectra_render::GhostNoise;
use spectra_scene::{FilmTime, NoiseLimit};
use std::path::Path;

/// Causes of loss that the summary names. Rays that the lens itself stops are not among them. Rays are aimed at a region a little
/// larger than the pupil, so that no light is missed, and those that miss the pupil end there.
const TELLING: [(Loss, &str); 3] = [
    (Loss::TotalReflection, "totally reflected"),
    (Loss::Absorbed, "absorbed"),
    (Loss::OutOfFrame, "beside the frame"),
];

impl Report<'_> {
    /// Describes the picture in a few lines, in a photographer's words.
    #[must_use]
    pub fn summary(&self) -> String {
        of(self)
    }
}

/// Formats the summary: `Zeiss Biotar 50 mm f/1.4 at f/2, focus 2 m, Kodak Tri-X 400 at 1/700 s (metered); 1 228 800 rays in 0.8 s,
/// 1.5 million rays/s, 39 % of them through the lens`.
fn of(report: &Report<'_>) -> String {
    let (scene, rendering) = (report.scene, report.rendering);
    if report.job.light == LightFrom::Pixels {
        return of_pixels(report);
    }
    let lens = scene.params.get("lens");
    let set = |key: &str| lens.and_then(|lens| lens.get(key));
    let mut text = scene.lens.name.clone();
    if let Some(stop) = set("f-number").and_then(f_number) {
        text.push_str(&format!(" at {stop}"));
    }
    if let Some(focus) = set("focus").and_then(|node| quantity(node.get("distance").unwrap_or(node), "mm")) {
        text.push_str(&format!(", focus {focus}"));
    }
    match report.times {
        [] => {}
        _ => text.push_str(&format!(", {}", all_exposed(report))),
    }
    text.push_str(&format!(
        "; {} rays in {}, {}",
        formatting::count(rendering.rays),
        formatting::duration(report.seconds),
        formatting::rate(report.rays_per_second())
    ));
    let losses = &rendering.losses;
    let stopped = losses.of_cause(Loss::Missed) + losses.of_cause(Loss::Vignetted);
    if stopped > 0 {
        let through = formatting::percent(rendering.rays.saturating_sub(stopped), rendering.rays);
        text.push_str(&format!(", {through} of them through the lens"));
    }
    for (cause, words) in TELLING {
        let many = losses.of_cause(cause);
        if many * 1000 >= rendering.rays.max(1) {
            text.push_str(&format!(", {} {words}", formatting::percent(many, rendering.rays)));
        }
    }
    if let Some(ledger) = rendering.ledger.as_ref().filter(|ledger| ledger.direct_w + ledger.ghosts_w > 0.0) {
        let why = match scene.render.reflections.order {
            None => " (bright enough to matter; `render.reflections.order: 0` leaves them out)",
            Some(_) => "",
        };
        let share = |part: f64| spectra_render::percent(part / ledger.emitted_w);
        text.push_str(&format!(
            ", ghosts along {}{why}: {} of what the lights emit, {} not traced after {} reflections",
            formatting::counted(ledger.paths.len() as u64, "path"),
            share(ledger.ghosts_w),
            share(ledger.not_traced_w),
            if ledger.order > 2 { "four" } else { "two" }
        ));
        if let Some(GhostNoise { noise, clean_samples: Some(samples) }) = rendering.ghost_noise {
            let [own, clean] = [noise, GhostNoise::CLEAN].map(spectra_render::percent);
            text.push_str(&format!(", with about {own} noise ({clean} with `render.samples: {samples}`)"));
        }
    }
    if let Some(glare) = rendering.glare {
        text.push_str(&format!(", veiling glare is {} of all light on the frame", spectra_render::percent(glare)));
    }
    if let Some(all) = rendering.diffraction.as_ref().filter(|all| !all.is_empty()) {
        let mean = |of: fn(&spectra_render::Diffracted) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
        let stars = all.iter().map(|d| d.stars).max().unwrap_or(0);
        let why = match scene.render.diffraction {
            None => " (stars are bright enough to matter; `render.diffraction: false` leaves it out)",
            Some(_) => "",
        };
        text.push_str(&format!(
            ", diffraction{why}: {} of the light of a point stays in its pixel, {} leaves the frame, stars of {} pixels",
            spectra_render::percent(mean(|d| d.stays)),
            spectra_render::percent(mean(|d| d.left.max(0.0))),
            formatting::count(stars as u64)
        ));
    }
    if let Some(noise) = rendering.noise {
        let (median, p95) = (spectra_render::percent(noise.median), spectra_render::percent(noise.p95));
        let asked = match (scene.render.noise, noise.by_grain) {
            (Some(NoiseLimit::Auto), true) => {
                format!("; asked: a third of the film's grain, {}", spectra_render::percent(noise.asked))
            }
            (Some(NoiseLimit::Auto), false) => format!("; asked: {}", spectra_render::percent(noise.asked)),
            _ => String::new(),
        };
        text.push_str(&format!(", noise {median} (95 % of the frame below {p95}{asked})"));
    }
    if let Some(meaning) = scene.source.meaning() {
        text.push_str(&format!("; {meaning}"));
    }
    if rendering.partial {
        let (samples, all) = (rendering.samples, u64::from(scene.render.samples));
        text.push_str(&match rendering.noise {
            Some(_) => "\npartial: stopped before it was clean".to_owned(),
            None if samples == 0 => "\npartial: stopped in the first sample of each pixel".to_owned(),
            None => format!("\npartial: stopped after {samples} of {all} samples per pixel"),
        });
    }
    text
}

/// Formats the summary of a film exposed to pixels:
/// `6000 x 4000 pixels on 36 x 24 mm, no lens, Kodak Tri-X 400 at 1/700 s (metered)`.
fn of_pixels(report: &Report<'_>) -> String {
    let size = report.rendering.exposure.size;
    let times = all_exposed(report);
    let [width, height] = [size.width_mm, size.height_mm].map(|mm| rounded(&mm.to_string()));
    format!("{} x {} pixels on {width} x {height} mm, no lens, {times}", size.width_px, size.height_px)
}

/// Describes how each film was exposed.
fn all_exposed(report: &Report<'_>) -> String {
    // A developed photograph has no scene file to edit, so messages name command-line options.
    let has_options = is_picture(Path::new(&report.job.scene_file));
    let one = |(at, time): (usize, &FilmTime)| {
        let gray = report.rendering.mid_gray.as_deref();
        exposed(time, gray.and_then(|gray| report.scene.stops_over_file(at, time, gray)), has_options)
    };
    report.times.iter().enumerate().map(one).collect::<Vec<_>>().join(", ")
}

/// Describes how a film was exposed: `Kodak Tri-X 400 at 1/700 s (metered)`. For a picture as source it adds the difference from
/// the file in stops. It also says how to change this, with an option of `film develop` or a key of the scene.
fn exposed(time: &FilmTime, stops: Option<f64>, has_options: bool) -> String {
    let key = |stops: &str| {
        if has_options { format!("`--exposure {stops}`") } else { format!("`film.compensation: {stops}`") }
    };
    // Less than five hundredths of a stop does not matter.
    let moved = stops.filter(|stops| stops.abs() >= 0.05);
    let metered = match (time.meter, moved) {
        (Some(_), _) if time.is_as_taken => format!(" (exposed as taken; {} adds a stop)", key("1")),
        (Some(meter), Some(stops)) => {
            let undone = key(&format!("{:.1}", -stops));
            format!(" (metered, {meter}: {stops:+.1} stops from the file as it is; {undone} undoes that)")
        }
        (Some(meter), None) => format!(" (metered, {meter})"),
        (None, _) if time.is_metered => " (metered)".to_owned(),
        (None, _) => String::new(),
    };
    let named = time.name.as_ref().map_or(String::new(), |name| format!("{name}: "));
    format!("{named}{} at {}{metered}", time.film, shutter::format_time(time.time_s))
}

/// Formats an f-number: `f/2.8`.
fn f_number(node: &Node) -> Option<String> {
    let text = scalar(node)?;
    Some(format!("f/{}", rounded(text.trim_start_matches("f/"))))
}

/// Formats a value with its unit, or with `unit` if it states none.
fn quantity(node: &Node, unit: &str) -> Option<String> {
    let text = scalar(node)?;
    let is_bare = matches!(node.value, Value::Number(_));
    Some(if is_bare { format!("{} {unit}", rounded(&text)) } else { rounded(&text) })
}

fn scalar(node: &Node) -> Option<String> {
    match &node.value {
        Value::Number(number) => Some(number.text.clone()),
        Value::String(text) => Some(text.clone()),
        _ => None,
    }
}

/// Rounds the number that a text begins with to four digits, and keeps the text after it.
fn rounded(text: &str) -> String {
    let end = text.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(text.len());
    let (number, rest) = text.split_at(end);
    match number.parse::<f64>() {
        Ok(value) if value > 0.0 && number.len() > 5 => {
            let digits = (3 - log10(value).floor() as i32).clamp(0, 12) as usize;
            let short = format!("{value:.digits$}");
            let short = if digits > 0 { short.trim_end_matches('0').trim_end_matches('.') } else { &short };
            format!("{short}{rest}")
        }
        _ => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let texts = ["66.66666666666667 cm", "2 m", "2.3157894", "1.414", "1234567 mm", "infinity"];
        assert_eq!(texts.map(rounded), ["66.67 cm", "2 m", "2.316", "1.414", "1234567 mm", "infinity"]);
    }
}
