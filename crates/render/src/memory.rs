//! Computes how much memory a picture needs, before any light is traced.

use crate::check_pixels::PIXELS_A_CHECK;
use spectra_core::params::{Faults, Value};
use spectra_scene::{Direction, FileContent, Lights, Scene};

/// Bytes of a sum, of which there is one for each pixel and channel.
const SUM: u64 = 8;
/// Number of pixels for each check pixel.
const CHECKS: u64 = PIXELS_A_CHECK as u64;
/// Bytes of an exposure, of which there is one for each pixel and channel.
const EXPOSURE: u64 = 4;
/// Bytes per pixel that an estimator of veiling glare stores.
const GAIN: u64 = 8;
/// Bytes per pixel that developing a film needs in addition to the exposure: convolved planes, densities, the picture.
const DEVELOPING: u64 = 40;
/// Bytes per pixel of a picture that an imager shows without film, and of packing it into a file.
const SHOWING: u64 = 16;

/// Returns the bytes of memory that rendering and writing a scene needs, beyond what the scene already holds.
#[must_use]
pub fn memory_needed(scene: &Scene) -> u64 {
    needed(scene, scene.ghost_paths() as u64)
}

/// Returns the bytes of memory that a scene needs with layers of this many ghost paths.
fn needed(scene: &Scene, paths: u64) -> u64 {
    let pixels = scene.imager.size().pixels() as u64;
    let channels = scene.channels.len() as u64;
    let is_shown = scene.output.iter().any(|o| matches!(o.content(), FileContent::Picture | FileContent::Numbers));
    // A meter's channels have no sums, but need as much while the meter looks. Lights that are rendered separately have their own sums.
    // Whether there are any is not known before the source is read.
    let apart = match scene.render.lights {
        Lights::Same => false,
        Lights::Auto => scene.source.split().is_some_and(|split| split.pays),
        Lights::Forward => true,
    };
    // Ghosts have their own sums, too. If the scene does not say, whether they matter is not known before they are searched.
    let ghosts = scene.render.reflections.order.map_or(apart, |order| order > 0);
    // With a limit on the noise, light that may land anywhere has two halves, and light of single pixels has sums of its check pixels.
    let is_limited = scene.render.noise.is_some();
    let halves = 1 + u64::from(is_limited);
    let is_local = scene.render.direction == Direction::Backward;
    // Light that haze, dust and scratches scatter is traced separately from the rest.
    let scattered = if scene.lens.scatters() { 1 + u64::from(apart) } else { 0 };
    // There is one veil of all light, or one of the lights and one of the rest, whether or not rendering lights separately pays.
    let emits = |split: spectra_core::stage::Split<'_>| split.lights.emit().is_some();
    let veils = if scene.render.glare.is_some() { 1 + u64::from(scene.source.split().is_some_and(emits)) } else { 0 };
    // Paths with layers have their own sums in addition to those of all ghosts.
    let kinds = 1 + u64::from(apart) + if ghosts { 1 + paths } else { 0 } + scattered + veils;
    // Layers of the kinds of light and of ghost paths, and the exposure before diffraction while diffraction is computed.
    let of_paths = if paths == 0 { 0 } else { 1 + if ghosts { paths } else { 0 } };
    let layers = scene.light_layers().len() as u64 + of_paths;
    let layers = if layers > 0 && scene.render.diffraction.unwrap_or(apart) { layers + 1 } else { layers };
    // Backward light has one kind, and one more of what is scattered.
    let local = if is_local { 1 + u64::from(scene.lens.scatters()) } else { 0 };
    let sums = SUM * halves * (kinds - local) + SUM * local + if is_limited { SUM * local / CHECKS } else { 0 };
    let traced = channels * (sums + EXPOSURE * (1 + layers)) + GAIN * veils;
    // The sums are freed by then. With several films, each is developed from a copy of its own channels.
    let picture = if scene.films.is_empty() { SHOWING } else { DEVELOPING + 3 * EXPOSURE * scene.films.len() as u64 };
    // A file with layers is written from a copy of them.
    let written = channels * EXPOSURE * (1 + 2 * layers) + if is_shown { picture } else { channels * EXPOSURE };
    pixels.saturating_mul(traced.max(written))
}

/// Formats a size for people, as in `3.5 GB`.
#[must_use]
pub fn bytes(bytes: u64) -> String {
    let mut size = bytes as f64;
    let mut units = ["bytes", "kB", "MB", "GB", "TB", "PB"].into_iter().peekable();
    let mut unit = units.next().unwrap_or_default();
    while size >= 1000.0 && units.peek().is_some() {
        size /= 1000.0;
        unit = units.next().unwrap_or_default();
    }
    if size < 10.0 && unit != "bytes" { format!("{size:.1} {unit}") } else { format!("{size:.0} {unit}") }
}

/// Checks whether rendering a scene fits into `available` bytes of memory.
///
/// # Errors
/// Returns a fault at the key that makes the scene too large: ghost paths, bands, or else the resolution.
pub fn fits(scene: &Scene, available: u64) -> Result<(), Faults> {
    let needed = memory_needed(scene);
    if needed <= available {
        return Ok(());
    }
    let size = scene.imager.size();
    let per = scene.channels.len();
    let paths = scene.ghost_paths() as u64;
    if let Some(fewer) = (0..paths).rev().find(|paths| self::needed(scene, *paths) <= available) {
        let text = format!(
            "layers of {paths} ghost paths, {} x {} pixels of {per} channel{} each, raise the picture's memory to {}, but only \
             {} are available",
            size.width_px,
            size.height_px,
            if per == 1 { "" } else { "s" },
            bytes(needed),
            bytes(available)
        );
        let hint = if fewer == 0 { "leave out `ghost-paths`".to_owned() } else { format!("`ghost-paths: {fewer}`") };
        let key = key_of_paths(scene).unwrap_or_else(|| "output".to_owned());
        return Err(scene.params.fault(&key, text).hint(format!("{hint}, or use a machine with more memory")).into());
    }
    let imager = scene.params.get("imager");
    let key = ["bands", "resolution"].into_iter().find(|key| imager.is_some_and(|node| node.get(key).is_some()));
    let key = key.map_or_else(|| "imager".to_owned(), |key| format!("imager.{key}"));
    let side = (available as f64 / needed as f64).sqrt();
    let smaller = [size.width_px, size.height_px].map(|px| ((f64::from(px) * side) as u32).max(1));
    let text = format!(
        "{} x {} pixels of {per} channel{} need {} of memory, but only {} are available",
        size.width_px,
        size.height_px,
        if per == 1 { "" } else { "s" },
        bytes(needed),
        bytes(available)
    );
    let fewer = if key.ends_with("bands") { "use fewer bands, " } else { "use " };
    let hint = format!("{fewer}`resolution: [{}, {}]`, or a machine with more memory", smaller[0], smaller[1]);
    Err(scene.params.fault(&key, text).hint(hint).into())
}

/// Returns the key with which a scene asks for layers of ghost paths.
fn key_of_paths(scene: &Scene) -> Option<String> {
    let Value::Seq(items) = &scene.params.get("output")?.value else { return None };
    let at = items.iter().position(|item| item.get("ghost-paths").is_some())?;
    Some(format!("output[{at}].ghost-paths"))
}

#[cfg(test)]
mod tests {
    use super::bytes;

    #[test]
    fn sizes_are_said_in_their_unit() {
        let said = [0, 999, 1000, 35_000_000, 3_539_000_000, u64::MAX].map(bytes);
        assert_eq!(said, ["0 bytes", "999 bytes", "1.0 kB", "35 MB", "3.5 GB", "18447 PB"]);
    }
}
