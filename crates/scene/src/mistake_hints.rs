//! Hints for what people write out of habit from other programs and cameras: `source: flower.jpg`, `blades: 6`, `fov: 40 deg`.

use crate::bundled::Bundled;
use spectra_core::math::tan;
use spectra_core::params::{Angle, Fault, Length, Node, Params, Value};

/// File extensions of pictures that can be read.
const PICTURES: [&str; 9] = ["exr", "png", "jpg", "jpeg", "tif", "tiff", "webp", "bmp", "hdr"];
/// Hint for users who name roll film instead of a frame format.
const OF_120: &str = "120 film holds frames of several shapes: `6x4.5`, `6x6`, `6x7`, `6x9`, `6x12` or `6x17`";

/// Returns the hint for a fault that is such a slip.
pub(crate) fn hint(fault: &Fault, scene: &Params) -> Option<String> {
    let root = scene.node();
    let key = fault.path.rsplit('.').next().unwrap_or_default();
    let section = fault.path.split(['.', '[']).next().unwrap_or_default();
    let at = |path: &str| root.at_path(path);
    if fault.message.starts_with("unknown key") {
        return unknown_key(section, key, at(&fault.path)?, root);
    }
    if key == "kind" && fault.message.starts_with("unknown ") {
        let stage = fault.path.strip_suffix(".kind").unwrap_or(section);
        return kind(stage, at(stage)?.as_str()?);
    }
    if fault.message.starts_with("unknown format `") {
        let name = written(at(&fault.path)?)?;
        return ["120", "220", "medium-format", "medium format"].contains(&name.as_str()).then(|| OF_120.to_owned());
    }
    if fault.path == "lens.aperture" {
        return aperture(at("lens.aperture")?.as_str()?);
    }
    if key == "grain" && fault.message.starts_with("found ") {
        let how = "the stock says how strong it is: `granularity: {rms: 11}` in a file with `like: kodak-tri-x-400`";
        return Some(format!("write `grain: false` or `grain: true`; {how}"));
    }
    if key == "halation" && fault.message.starts_with("unknown value") {
        let stronger = "{entering: 0.3, transmittance: 0.35}";
        return Some(format!(
            "write `halation: off` for none, or a map such as `halation: {stronger}`; without `halation`, the stock's values hold"
        ));
    }
    let is_text_wanted = fault.hint.is_none() && fault.message.ends_with("expected a text");
    if is_text_wanted && ["illuminant", "spectrum"].contains(&key) {
        return Some(format!(
            "write the name of a light (`{key}: D55`), an expression (`{key}: \"blackbody:3200\"`), or a file of two columns, \
             wavelength and value (`{key}: lamp.csv`)"
        ));
    }
    if fault.hint.as_deref().is_some_and(|hint| hint.starts_with("write it as in"))
        && let Some(percent) = at(&fault.path).and_then(written)
        && let Some(part) = percent.strip_suffix('%').and_then(|number| number.trim().parse::<f64>().ok())
    {
        return Some(format!("write it as a fraction of 1: `{}`", part / 100.0));
    }
    None
}

/// Returns a scalar as it was written.
fn written(node: &Node) -> Option<String> {
    match &node.value {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) => Some(number.text.clone()),
        _ => None,
    }
}

fn unknown_key(section: &str, key: &str, value: &Node, root: &Node) -> Option<String> {
    let given = written(value);
    match (section, key) {
        ("lens", "blades" | "aperture-blades" | "iris") => {
            let blades = given.filter(|text| text.parse::<u8>().is_ok()).unwrap_or("6".to_owned());
            Some(format!("the blades belong to the stop: `aperture: {{shape: iris, blades: {blades}}}`"))
        }
        ("lens", "focal_length" | "focal" | "zoom") => {
            let to = given.map_or("85mm".to_owned(), |text| text.replace(' ', ""));
            let to = if to.ends_with(|c: char| c.is_ascii_digit()) { format!("{to}mm") } else { to };
            Some(format!(
                "`focal-length: {to}` scales the whole lens; `spectra list lens` shows which focal lengths there are"
            ))
        }
        ("source", "fov" | "field-of-view" | "angle-of-view") => Some(width_of_view(value, root)),
        ("lens" | "imager" | "render" | "fov", "fov" | "field-of-view" | "angle-of-view") => Some(
            "the angle of view follows from the lens and the frame: `lens: {file: ...}` and `imager: {format: ...}`; a flat source that \
             fills it has `width: fill`"
                .to_owned(),
        ),
        (_, "sun") => Some(
            "the sun is a source, alone or over another one: `source: {kind: sun, field: [15 deg, 9 deg], over: {kind: picture, ...}}`"
                .to_owned(),
        ),
        (_, "iso") => Some("the film sets the speed: `film: {stock: kodak-tri-x-400, metering: average}`; `compensation: 1` adds a stop".to_owned()),
        _ => None,
    }
}

/// Returns a hint with the width of a source that spans this angle at its distance.
fn width_of_view(value: &Node, root: &Node) -> String {
    let angle = value.parse::<Angle>().ok().map(Angle::rad).filter(|rad| (0.0..std::f64::consts::PI).contains(rad));
    let distance = root.at_path("source.distance").and_then(|node| node.parse::<Length>().ok()).map(Length::mm);
    let width = match (angle, distance) {
        (Some(rad), Some(mm)) => {
            format!(", or `width: {:.0} mm`, which is this angle at its distance", 2.0 * mm * tan(rad / 2.0))
        }
        _ => String::new(),
    };
    format!("`width: fill` fills the frame of the lens{width}")
}

/// Returns a hint for a picture, or for a kind followed by its keys, written as a kind.
fn kind(stage: &str, typed: &str) -> Option<String> {
    let ending = typed.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
    if stage == "source" && ending.is_some_and(|ending| PICTURES.contains(&ending.as_str())) {
        return Some(format!(
            "write a picture as `source: {{kind: picture, file: {typed}, distance: 2 m, width: fill}}`"
        ));
    }
    let (name, keys) = typed.split_once('{')?;
    let keys: Vec<String> = keys
        .trim_end_matches('}')
        .split(',')
        .filter_map(|pair| pair.split_once(':').map(|(key, value)| format!("{}: {}", key.trim(), value.trim())))
        .collect();
    let own = stage.rsplit('.').next().unwrap_or(stage);
    (!keys.is_empty()).then(|| format!("write `{own}: {{kind: {}, {}}}`", name.trim(), keys.join(", ")))
}

/// Returns a hint for a drawing, a shape or a number of blades written as the `aperture`.
fn aperture(typed: &str) -> Option<String> {
    let ending = typed.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
    if ending.is_some_and(|ending| ending == "svg" || PICTURES.contains(&ending.as_str())) {
        return Some(format!(
            "write a drawing at the stop as `aperture: {{shape: mask, file: {typed}, width: 24 mm}}`"
        ));
    }
    let number: String = typed.chars().take_while(char::is_ascii_digit).collect();
    match (typed, number.parse::<u8>()) {
        ("iris" | "round" | "circle" | "hexagon", _) => Some("`aperture: {shape: iris, blades: 6}`".to_owned()),
        (_, Ok(blades)) if blades >= 3 => Some(format!("`aperture: {{shape: iris, blades: {blades}}}`")),
        _ => None,
    }
}

/// Returns a hint for a film `typed` that is not bundled. It lists the most similar names of `camera`, the camera films, those
/// with the same words or speed first.
#[must_use]
pub fn other_films(typed: &str, camera: &[String]) -> String {
    let words = |name: &str| -> Vec<String> {
        let parts = name.to_ascii_lowercase();
        parts.split(['-', ' ', '_']).filter(|word| word.len() > 1).map(str::to_owned).collect()
    };
    let digits = |word: &str| word.chars().filter(char::is_ascii_digit).collect::<String>();
    let mine = words(typed);
    // An equal word counts more than an equal speed.
    let likeness = |name: &String| -> usize {
        let theirs = words(name);
        let same = mine.iter().filter(|word| theirs.contains(word)).count();
        let speed =
            mine.iter().filter(|w| digits(w).len() > 1 && theirs.iter().any(|t| digits(t) == digits(w))).count();
        2 * same + speed
    };
    let mut films: Vec<&String> = camera.iter().filter(|name| likeness(name) > 0).collect();
    films.sort_by_key(|name| std::cmp::Reverse(likeness(name)));
    let near: Vec<String> = films.iter().take(4).map(|name| format!("`{name}`")).collect();
    let list = Bundled::Stock.listed_by();
    let near = match &near[..] {
        [] => format!("known: {}", spectra_core::names::listed(camera, list)),
        near => format!("the nearest are {}; `{list}` shows all", near.join(", ")),
    };
    format!("{near}; `spectra new film NAME` writes the file of another film")
}
