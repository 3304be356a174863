//! How much memory a picture takes: known before any light is traced.

use spectra_core::params::{Faults, Value};
use spectra_scene::{Holds, Lights, Scene};

/// Bytes of a sum and of an exposure: one of each, a pixel and channel.
const SUM: u64 = 8;
const EXPOSURE: u64 = 4;
/// Bytes of what a veil knows of each pixel.
const GAIN: u64 = 8;
/// Bytes a pixel that developing a film takes beside the exposure: planes that are convolved, densities, the picture.
const DEVELOPING: u64 = 40;
/// Bytes a pixel of a picture that an imager shows by itself, and of packing it into a file.
const SHOWING: u64 = 16;

/// Bytes that rendering and writing a scene takes beyond what the scene holds already.
#[must_use]
pub fn memory_needed(scene: &Scene) -> u64 {
    needed(scene, scene.ghost_paths() as u64)
}

/// The same with layers of so many paths of ghosts.
fn needed(scene: &Scene, paths: u64) -> u64 {
    let pixels = scene.imager.size().pixels() as u64;
    let channels = scene.channels.len() as u64;
    let is_shown = scene.output.iter().any(|o| matches!(o.holds(), Holds::Picture | Holds::Numbers));
    // A meter's channels have no sums, but as much for its own figures while it looks.
    // Lights that are rendered apart have sums of their own; before the source is read it is not known whether there are any.
    let apart = match scene.render.lights {
        Lights::Same => false,
        Lights::Auto => scene.source.split().is_some_and(|split| split.pays),
        Lights::Forward => true,
    };
    // So have ghosts; where the scene does not say, whether they matter is not known before they are looked for.
    let ghosts = scene.render.reflections.order.map_or(apart, |order| order > 0);
    let halves = 1 + u64::from(scene.render.noise.is_some());
    // What haze, dust and scratches scatter is traced beside what they do not.
    let scattered = if scene.lens.scatters() { 1 + u64::from(apart) } else { 0 };
    // The veil is one of all light, or one of lights and one of the rest, whether or not it pays to render lights apart.
    let emits = |split: spectra_core::stage::Split<'_>| split.lights.emit().is_some();
    let veils = if scene.render.glare.is_some() { 1 + u64::from(scene.source.split().is_some_and(emits)) } else { 0 };
    // Paths that have layers have sums of their own beside those of all ghosts.
    let kinds = 1 + u64::from(apart) + if ghosts { 1 + paths } else { 0 } + scattered + veils;
    // Layers of kinds of light and of paths, and the exposure before diffraction while it is worked out.
    let of_paths = if paths == 0 { 0 } else { 1 + if ghosts { paths } else { 0 } };
    let layers = scene.light_layers().len() as u64 + of_paths;
    let layers = if layers > 0 && scene.render.diffraction.unwrap_or(apart) { layers + 1 } else { layers };
    let traced = channels * (SUM * halves * kinds + EXPOSURE * (1 + layers)) + GAIN * veils;
    // Sums are gone by then. Of several films each is developed from a copy of its own channels.
    let picture = if scene.films.is_empty() { SHOWING } else { DEVELOPING + 3 * EXPOSURE * scene.films.len() as u64 };
    // A file of layers is written from a copy of them.
    let written = channels * EXPOSURE * (1 + 2 * layers) + if is_shown { picture } else { channels * EXPOSURE };
    pixels.saturating_mul(traced.max(written))
}

/// A size for people: `3.5 GB`.
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

/// Whether a scene fits into so many bytes.
///
/// # Errors
/// A fault at what makes it large: the bands, or else the resolution.
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
            "layers of {paths} paths of ghosts, {} x {} pixels of {per} channel{} each, bring the picture to {} of memory, and {} are available",
            size.width_px,
            size.height_px,
            if per == 1 { "" } else { "s" },
            bytes(needed),
            bytes(available)
        );
        let hint = if fewer == 0 { "leave `ghost-paths` out".to_owned() } else { format!("`ghost-paths: {fewer}`") };
        let key = key_of_paths(scene).unwrap_or_else(|| "output".to_owned());
        return Err(scene.params.fault(&key, text).hint(format!("{hint}, or a machine with more memory")).into());
    }
    let imager = scene.params.get("imager");
    let key = ["bands", "resolution"].into_iter().find(|key| imager.is_some_and(|node| node.get(key).is_some()));
    let key = key.map_or_else(|| "imager".to_owned(), |key| format!("imager.{key}"));
    let side = (available as f64 / needed as f64).sqrt();
    let smaller = [size.width_px, size.height_px].map(|px| ((f64::from(px) * side) as u32).max(1));
    let text = format!(
        "{} x {} pixels of {per} channel{} need {} of memory, and {} are available",
        size.width_px,
        size.height_px,
        if per == 1 { "" } else { "s" },
        bytes(needed),
        bytes(available)
    );
    let fewer = if key.ends_with("bands") { "fewer bands, or " } else { "" };
    let hint = format!("{fewer}`resolution: [{}, {}]`, or a machine with more memory", smaller[0], smaller[1]);
    Err(scene.params.fault(&key, text).hint(hint).into())
}

/// Where a scene asks for layers of paths.
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
