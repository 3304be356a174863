//! Controls of the page: one for each number, choice and switch that the scene's stages declare.
//!
//! A page sends numbers, switches and words of a control's own list, never free text. The values for the scene are put together here, so
//! no file path comes from a page.

use serde_json::{Value, json};
use spectra_core::params::{Node, Value as Written};
use spectra_core::registry::{self, Listed, Parameter, Stage, ValueForm};
use spectra_film::stock::{Process, Stock};
use spectra_lens::Coating;
use spectra_scene::bundled::Bundled;
use spectra_scene::{FileKind, FileResources, NO_LENS, Series, SeriesKind, file_documentation, shared_documentation};
use spectra_session::Session;
use spectra_spectrum::bundled_spectra;
use std::path::Path;
use std::sync::LazyLock;

/// The kind of a control's value, and how it is written.
#[derive(Clone, Debug, PartialEq)]
enum Kind {
    /// A number from `least` to `most`, with a text before it and a unit behind it.
    Number { before: &'static str, unit: String, least: Option<f64>, most: Option<f64>, whole: bool },
    /// A list of two numbers with the same unit and range.
    Pair { unit: String, least: Option<f64>, most: Option<f64> },
    /// One of these words.
    Choice(Vec<String>),
    /// A value that is true or false.
    Switch,
}

/// A control of the page: one value of the scene that can be changed.
#[derive(Clone, Debug)]
pub(crate) struct Control {
    path: String,
    kind: Kind,
    /// Value in the scene; null if the scene leaves it out.
    value: Value,
    help: String,
    /// Whether the control is shown at once, because the scene sets it or most people look for it.
    is_in_front: bool,
    /// Text before and behind the number, if the number alone is not the value.
    within: Option<[&'static str; 2]>,
    /// Whether the control selects a picture of a sweep, or a frame of an animation, and changes none of them.
    picks: bool,
    /// Reason why the control cannot be changed; `None` if it can.
    fixed: Option<String>,
    /// Start of the control's scale, if it differs from the range: a lens cannot be opened beyond its own f-number.
    from: Option<f64>,
}

/// Path of the control that selects the picture of a series.
pub(crate) const PICTURE: &str = "picture";

/// Keys that are shown at once even if a scene leaves them out.
const IN_FRONT: [&str; 14] = [
    "lens.file",
    "lens.f-number",
    "lens.focus",
    "lens.coating",
    "lens.aperture",
    "film.stock",
    "film.exposure",
    "film.compensation",
    "film.push",
    "film.print",
    "film.paper.grade",
    "film.grain",
    "imager.tilt",
    "imager.shift",
];
/// Keys that the viewer sets itself, or that say how the work is divided and not what the picture is.
const OWN: [&str; 4] = ["imager.resolution", "imager.crop", "render.batch", "render.frame"];
/// Keys that have no effect if a photograph's own pixels are developed, because no ray is traced.
const OF_RAYS: [&str; 10] = [
    "lens.f-number",
    "lens.focus",
    "lens.aperture",
    "lens.coating",
    "imager.tilt",
    "imager.shift",
    "source.distance",
    "source.width",
    "render.",
    "wavelengths.",
];
const LIGHTS: [&str; 3] = ["illuminant", "lamp", "light"];

/// Sections of a scene, each with the kind of stage that it holds.
const SECTIONS: [(&str, &str); 5] = [
    ("film", "film"),
    ("imager", "imager"),
    ("imager.response", "response"),
    ("source", "source"),
    ("wavelengths", "wavelengths"),
];

/// The parameters that this program's stages declare. They are the same for every scene, and slow to gather.
struct Declared {
    stages: Vec<(Listed, Vec<Parameter>)>,
    shared: Vec<(&'static str, Vec<Parameter>)>,
    /// Parameters of the sections `lens` and `render`, which hold no stage.
    of_file: Vec<Parameter>,
    /// Names of the coatings that have no required parameters, so that a name alone stands for them.
    coatings: Vec<String>,
}

static DECLARED: LazyLock<Declared> = LazyLock::new(|| {
    let is_wanted = |stage: &str| SECTIONS.iter().any(|(_, of)| *of == stage);
    let stages = registry::list().into_iter().filter(|listed| is_wanted(listed.stage));
    let of_stage = |stage| shared_documentation(stage).map(|found| (stage, found.parameters));
    let mut of_file = file_documentation(FileKind::Scene).parameters;
    of_file.retain(|parameter| parameter.key.starts_with("lens.") || parameter.key.starts_with("render."));
    let has_no_required =
        |listed: &Listed| listed.documentation().parameters.iter().all(|parameter| !parameter.required);
    let coatings =
        registry::list().into_iter().filter(|listed| listed.stage == Coating::NAME && has_no_required(listed));
    Declared {
        coatings: coatings.map(|listed| listed.name.to_owned()).collect(),
        stages: stages.map(|listed| (listed, listed.documentation().parameters)).collect(),
        shared: SECTIONS.iter().filter_map(|(_, stage)| of_stage(*stage)).collect(),
        of_file,
    }
});

/// Names of the bundled camera stocks, and of the bundled print stocks.
static STOCKS: LazyLock<[Vec<String>; 2]> = LazyLock::new(|| {
    let bundled = FileResources::beside(Path::new(""));
    let mut both = [Vec::new(), Vec::new()];
    for name in Stock::bundled() {
        if let Ok(stock) = Stock::load(name, &bundled) {
            both[usize::from(stock.process == Process::Print)].push(name.to_owned());
        }
    }
    both
});

/// The camera stocks as the page shows them side by side: name, title, speed and kind.
static TILES: LazyLock<Value> = LazyLock::new(|| {
    let bundled = FileResources::beside(Path::new(""));
    let tile = |name: &String| {
        let stock = Stock::load(name, &bundled).ok()?;
        let kind = match stock.process {
            _ if stock.layers.len() == 1 => "gray",
            Process::Reversal => "slide",
            _ => "color",
        };
        Some(json!({"word": name, "title": stock.name, "iso": stock.iso, "kind": kind}))
    };
    STOCKS[0].iter().filter_map(tile).collect()
});

/// Gathers the data that all scenes have in common, ahead of the first page.
pub(crate) fn gather() {
    LazyLock::force(&DECLARED);
    LazyLock::force(&TILES);
}

/// Returns the controls of a scene, given the root of its tree as written.
fn of_scene(root: &Node) -> Vec<Control> {
    let mut all = Vec::new();
    let Declared { stages, shared, of_file, .. } = &*DECLARED;
    let mut section = |prefix: &str, stage: &str| {
        let Some(node) = root.at_path(prefix).filter(|node| matches!(node.value, Written::Map(_))) else { return };
        let of_stage = || stages.iter().filter(|(listed, _)| listed.stage == stage);
        let said = of_stage().next().and_then(|(listed, _)| node.get(listed.key)).and_then(Node::as_str);
        let listed = of_stage().find(|(listed, _)| said.map_or(listed.default, |name| name == listed.name));
        let own = listed.map_or(&[][..], |(_, own)| own);
        let shared = shared.iter().filter(|(of, _)| *of == stage).flat_map(|(_, keys)| keys);
        for parameter in own.iter().chain(shared) {
            all.extend(control(root, &format!("{prefix}.{}", parameter.key), parameter));
        }
    };
    for (prefix, stage) in SECTIONS {
        section(prefix, stage);
    }
    for parameter in of_file {
        all.extend(control(root, &parameter.key, parameter));
    }
    all.push(blades(root));
    // If a key is declared several times, the first declaration holds. A map where a number could be has its own controls.
    let mut seen = std::collections::BTreeSet::new();
    all.retain(|control| seen.insert(control.path.clone()));
    all.retain(|control| {
        let at = root.at_path(&control.path).map(|node| &node.value);
        control.within.is_some() || !matches!(at, Some(Written::Map(_)))
    });
    let of_map = |path: &str| path.rsplit_once('.').map(|(before, _)| before.to_owned());
    all.retain(|control| {
        // If `lens.focus` is a length, a control for `lens.focus.distance` would replace it.
        let is_number =
            |path: &str| root.at_path(path).is_some_and(|node| !matches!(node.value, Written::Map(_) | Written::Null));
        of_map(&control.path).is_none_or(|parent| !is_number(&parent))
    });
    all
}

/// Returns the controls of a session: those of its scene, with controls that select among the pictures of its series.
pub(crate) fn of_session(session: &Session) -> Vec<Control> {
    let mut all = of_scene(session.scene().params.node());
    let series = session.series();
    for control in all.iter_mut().filter(|control| control.path == "lens.f-number") {
        control.from = session.scene().lens.nominal_f_number;
    }
    if is_flat_picture(session.scene().params.node()) {
        // A flat picture has no depth to control.
        all.retain(|control| !control.path.starts_with("source.depth"));
    }
    if series.is_without_lens() {
        // Without rays, these controls have no effect.
        all.retain(|control| !OF_RAYS.iter().any(|path| control.path.starts_with(path)));
    }
    if series.count() < 2 {
        return all;
    }
    let (count, at) = (series.count(), session.index());
    let members: Vec<Vec<(String, String)>> = (0..count).map(|index| series.member(index).values).collect();
    let is_sweep = matches!(series.kind(), SeriesKind::Sweep { .. });
    let mut paths: Vec<&String> = Vec::new();
    for (path, _) in members.iter().flatten() {
        if !paths.contains(&path) {
            paths.push(path);
        }
    }
    for path in paths {
        let below = |own: &str| own.strip_prefix(path.as_str()).is_some_and(|rest| rest.starts_with(['.', '[']));
        let why = if is_sweep {
            format!("the sweep sets `{path}` for each picture")
        } else {
            format!("the animation sets `{path}` for each frame")
        };
        let is_own = |control: &Control| control.path == *path || (!is_sweep && path.starts_with(&*control.path));
        for control in all.iter_mut().filter(|control| below(&control.path) || is_own(control)) {
            control.fixed = Some(why.clone());
        }
        if !is_sweep {
            continue;
        }
        let of = |index: usize| members[index].iter().find(|(own, _)| own == path).map(|(_, value)| value.clone());
        let mut words: Vec<String> = Vec::new();
        for word in (0..count).filter_map(of) {
            if !words.contains(&word) {
                words.push(word);
            }
        }
        let choice = Control {
            path: path.clone(),
            kind: Kind::Choice(words),
            value: of(at).map_or(Value::Null, Value::String),
            help: "Values of the sweep; each selects one of its pictures.".to_owned(),
            is_in_front: true,
            within: None,
            picks: true,
            fixed: None,
            from: None,
        };
        match all.iter_mut().find(|control| control.path == *path) {
            Some(control) => *control = Control { help: control.help.clone(), ..choice },
            None => all.push(choice),
        }
    }
    all.insert(0, chooser(series, at, is_sweep));
    all
}

/// Returns the control that selects the picture of a series.
fn chooser(series: &Series, at: usize, is_sweep: bool) -> Control {
    let said = |index: usize| format!("{}: {}", index + 1, series.member(index).words());
    let (kind, value) = if is_sweep {
        (Kind::Choice((0..series.count()).map(said).collect()), json!(said(at)))
    } else {
        let most = series.count() as f64;
        let kind = Kind::Number { before: "", unit: String::new(), least: Some(1.0), most: Some(most), whole: true };
        (kind, json!(at + 1))
    };
    let help = if is_sweep { "The picture of the sweep." } else { "The frame of the animation, counted from 1." };
    let help = help.to_owned();
    Control {
        path: PICTURE.to_owned(),
        kind,
        value,
        help,
        is_in_front: true,
        within: None,
        picks: true,
        fixed: None,
        from: None,
    }
}

/// Returns the control for the blades of the iris, which are in a map of their own.
fn blades(root: &Node) -> Control {
    let at = root.at_path("lens.aperture.blades").and_then(number);
    Control {
        path: if at.is_some() { "lens.aperture.blades" } else { "lens.aperture" }.to_owned(),
        kind: Kind::Number { before: "", unit: String::new(), least: Some(3.0), most: Some(100.0), whole: true },
        value: at.as_ref().map_or(Value::Null, |(_, value, _)| json!(value)),
        help: "Number of blades of the iris; the opening is round if left out.".to_owned(),
        is_in_front: true,
        within: at.is_none().then_some(["{shape: iris, blades: ", "}"]),
        picks: false,
        fixed: None,
        from: None,
    }
}

/// Returns the control for a parameter; `None` for lists, maps, and texts that are not one of a list of names.
fn control(root: &Node, path: &str, parameter: &Parameter) -> Option<Control> {
    if OWN.contains(&path) || path.contains("[]") || path.ends_with(".kind") {
        return None;
    }
    let node = root.at_path(path).filter(|node| !matches!(node.value, Written::Null));
    let [least, most] = parameter.range.limits();
    let written = node.and_then(number);
    let unit = match (&written, parameter.unit.as_str()) {
        (Some((_, _, unit)), _) => unit.clone(),
        // Distances are in a photographer's unit.
        (None, "mm") if path.contains("focus") || path.contains("distance") => "m".to_owned(),
        (None, "f/") => String::new(),
        (None, unit) => unit.to_owned(),
    };
    let kind = if path == "film.paper.grade" {
        Kind::Choice(["0", "1", "2", "3", "4", "5", "auto"].map(str::to_owned).into())
    } else if let Some(mut names) = names(path) {
        if path == "lens.file" && is_flat_picture(root) {
            names.insert(0, NO_LENS.to_owned());
        }
        Kind::Choice(names)
    } else {
        match parameter.form.usual() {
            ValueForm::Boolean => Kind::Switch,
            ValueForm::Choice(words) => Kind::Choice(words.clone()),
            ValueForm::List { count: Some(2), of } if matches!(**of, ValueForm::Quantity { .. }) => {
                Kind::Pair { unit: parameter.unit.clone(), least, most }
            }
            form @ (ValueForm::Integer | ValueForm::Number | ValueForm::Quantity { .. }) => {
                let before = if parameter.unit == "f/" { "f/" } else { "" };
                Kind::Number { before, unit, least, most, whole: *form == ValueForm::Integer }
            }
            _ => return None,
        }
    };
    let value = match (&kind, node) {
        (Kind::Number { .. }, _) => written.map(|(_, value, _)| json!(value)),
        (Kind::Pair { .. }, Some(node)) => {
            let one = |index| node.element(index).and_then(number).map(|(_, value, _)| value);
            one(0).zip(one(1)).map(|(a, b)| json!([a, b]))
        }
        (Kind::Switch, Some(node)) => match node.value {
            Written::Bool(is_on) => Some(json!(is_on)),
            _ => None,
        },
        (Kind::Choice(_), Some(node)) => match &node.value {
            Written::String(text) => Some(json!(text)),
            Written::Number(number) => Some(json!(number.text)),
            _ => None,
        },
        (_, None) => None,
    };
    // A number written as a word, such as `inf`, has no value here; it stays as written until the control is changed.
    let help = parameter.description.split_whitespace().collect::<Vec<_>>().join(" ");
    let is_in_front = node.is_some() || IN_FRONT.contains(&path);
    let value = value.unwrap_or(Value::Null);
    Some(Control {
        path: path.to_owned(),
        kind,
        value,
        help,
        is_in_front,
        within: None,
        picks: false,
        fixed: None,
        from: None,
    })
}

/// Returns whether the source is a flat picture, which can be exposed on film without a lens.
fn is_flat_picture(root: &Node) -> bool {
    let says = |path: &str| root.at_path(path).and_then(Node::as_str);
    says("source.kind") == Some("picture") && root.at_path("source.depth").is_none()
}

/// Returns the names that are allowed as the text at a path; `None` if there is no list of names for it.
fn names(path: &str) -> Option<Vec<String>> {
    let key = path.rsplit('.').next().unwrap_or_default();
    Some(match (path, key) {
        // Names in folders are parts for tests; a word from a page never holds a `/`.
        ("lens.file", _) => Bundled::Lens.names().into_iter().filter(|name| !name.contains('/')).collect(),
        ("lens.coating", _) => DECLARED.coatings.clone(),
        ("film.stock", _) => STOCKS[0].clone(),
        ("film.print", _) => STOCKS[1].clone(),
        ("film.halation" | "film.optics", _) => vec!["off".to_owned()],
        (_, key) if LIGHTS.contains(&key) => {
            let all = bundled_spectra().filter(|(_, path)| path.starts_with("spectra/illuminants/"));
            all.map(|(name, _)| name.to_owned()).collect()
        }
        _ => return None,
    })
}

/// Describes a range in words, for a message.
fn range_said(least: Option<f64>, most: Option<f64>, unit: &str) -> String {
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    match (least, most) {
        (Some(least), Some(most)) => format!("it goes from {least} to {most}{unit}"),
        (Some(least), None) => format!("it is at least {least}{unit}"),
        (None, Some(most)) => format!("it is at most {most}{unit}"),
        (None, None) => "any number".to_owned(),
    }
}

/// Reads a number as it is written: the text before it, its value and its unit. `None` if it is not a finite number.
fn number(node: &Node) -> Option<(&'static str, f64, String)> {
    match &node.value {
        Written::Number(number) if number.value.is_finite() => Some(("", number.value, String::new())),
        Written::String(text) => {
            let (before, rest) = match text.strip_prefix("f/") {
                Some(rest) => ("f/", rest),
                None => ("", text.as_str()),
            };
            let rest = rest.trim();
            let is_digit = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | '/');
            let (digits, unit) = rest.split_at(rest.find(|c| !is_digit(c)).unwrap_or(rest.len()));
            let value = match digits.split_once('/') {
                Some((a, b)) => a.parse::<f64>().ok()? / b.parse::<f64>().ok()?,
                None => digits.parse().ok()?,
            };
            value.is_finite().then(|| (before, value, unit.trim().to_owned()))
        }
        _ => None,
    }
}

impl Control {
    /// Path of the control's value in the scene.
    pub(crate) fn path(&self) -> &str {
        &self.path
    }

    /// Unit of the control's numbers; empty if they have none.
    fn unit(&self) -> &str {
        match &self.kind {
            Kind::Number { unit, .. } | Kind::Pair { unit, .. } => unit,
            Kind::Choice(_) | Kind::Switch => "",
        }
    }

    /// Returns the control as JSON for the page.
    pub(crate) fn to_json(&self) -> Value {
        let kind = match &self.kind {
            Kind::Number { before, unit, least, most, whole } => {
                json!({"is": "number", "before": before, "unit": unit, "least": least, "most": most, "whole": whole})
            }
            Kind::Pair { unit, least, most } => json!({"is": "pair", "unit": unit, "least": least, "most": most}),
            Kind::Choice(words) if self.path == "film.stock" && !self.picks => {
                json!({"is": "choice", "words": words, "tiles": *TILES})
            }
            Kind::Choice(words) => json!({"is": "choice", "words": words}),
            Kind::Switch => json!({"is": "switch"}),
        };
        json!({
            "path": self.path,
            "kind": kind,
            "value": self.value,
            "help": self.help,
            "front": self.is_in_front,
            "fixed": self.fixed,
            "from": self.from,
        })
    }

    /// Returns the word for `value` that selects a picture of the series; `None` if the control selects none.
    pub(crate) fn picked(&self, value: &Value) -> Option<String> {
        let word = || value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        self.picks.then(word)
    }

    /// Returns the text `path=value` for a value that a page sent.
    ///
    /// # Errors
    /// The reason why this control cannot have the value.
    pub(crate) fn text(&self, value: &Value) -> Result<String, String> {
        if let Some(why) = &self.fixed {
            return Err(why.clone());
        }
        let bounded = |value: &Value, least: Option<f64>, most: Option<f64>| match value.as_f64() {
            Some(number) if !number.is_finite() => Err("not a finite number".to_owned()),
            Some(number) if least.is_some_and(|least| number < least) || most.is_some_and(|most| number > most) => {
                Err(format!("{number} is out of range: {}", range_said(least, most, self.unit())))
            }
            Some(number) => Ok(number),
            None => Err("not a number".to_owned()),
        };
        let with_unit = |unit: &str| if unit.is_empty() { String::new() } else { format!(" {unit}") };
        let written = match &self.kind {
            Kind::Number { before, unit, least, most, whole } => {
                let number = bounded(value, *least, *most)?;
                if *whole && number.fract() != 0.0 {
                    return Err("not a whole number".to_owned());
                }
                format!("{before}{number}{}", with_unit(unit))
            }
            Kind::Pair { unit, least, most } => match value.as_array().map(Vec::as_slice) {
                Some([a, b]) => {
                    let (a, b, unit) = (bounded(a, *least, *most)?, bounded(b, *least, *most)?, with_unit(unit));
                    format!("[{a}{unit}, {b}{unit}]")
                }
                _ => return Err("not two numbers".to_owned()),
            },
            Kind::Choice(words) => match value.as_str() {
                Some(word) if words.iter().any(|known| known == word) => word.to_owned(),
                _ => return Err("not one of the choices".to_owned()),
            },
            Kind::Switch => value.as_bool().ok_or("neither true nor false")?.to_string(),
        };
        let [before, behind] = self.within.unwrap_or(["", ""]);
        Ok(format!("{}={before}{written}{behind}", self.path))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_plugins as _;

    fn controls(text: &str) -> Vec<Control> {
        let file = spectra_core::params::SourceFile::new("scene.yaml", text);
        of_scene(&spectra_yaml::parse(file).expect("YAML"))
    }

    const SCENE: &str = "source: {kind: chart, chart: resolution, distance: 2 m, luminance: 300 cd/m2}\n\
        lens: {file: zeiss-biotar-50-f1.4, f-number: f/2, focus: 2 m}\n\
        imager: {kind: film, format: 135}\nfilm: {stock: ilford-ortho-plus, exposure: 1/80 s}\nrender: {samples: 8}\n";

    fn of(all: &[Control], path: &str) -> Control {
        all.iter().find(|c| c.path == path).unwrap_or_else(|| panic!("no control {path}")).clone()
    }

    #[test]
    fn numbers_keep_their_units_and_their_ranges() {
        let all = controls(SCENE);
        assert_eq!(of(&all, "lens.f-number").text(&json!(2.8)), Ok("lens.f-number=f/2.8".to_owned()));
        assert_eq!(of(&all, "lens.focus").text(&json!(1.5)), Ok("lens.focus=1.5 m".to_owned()));
        assert_eq!(of(&all, "film.exposure").value, json!(0.0125));
        assert_eq!(of(&all, "imager.tilt").text(&json!([3, 0])), Ok("imager.tilt=[3 deg, 0 deg]".to_owned()));
        let blades = of(&all, "lens.aperture");
        assert_eq!(blades.text(&json!(7)), Ok("lens.aperture={shape: iris, blades: 7}".to_owned()));
        assert!(blades.text(&json!(2)).is_err() && blades.text(&json!(7.5)).is_err());
        assert!(of(&all, "imager.tilt").text(&json!([81, 0])).is_err());
        assert!(all.iter().all(|c| c.path != "imager.resolution" && c.path != "lens.focus.distance"));
    }

    #[test]
    fn words_come_from_lists_alone() {
        let all = controls(SCENE);
        let lens = of(&all, "lens.file");
        assert!(lens.text(&json!("nikon-nikkor-50-f1.4")).is_ok() || lens.text(&json!("helios-44-58-f2")).is_ok());
        for bad in ["../../etc/passwd", "/etc/passwd", "lens.yaml", "a\\b", "", "{}", "[1]"] {
            assert!(lens.text(&json!(bad)).is_err(), "{bad}");
        }
        // A page may only send words of these lists, and none of the words is a path.
        for control in &all {
            if let Kind::Choice(words) = &control.kind {
                assert!(!words.is_empty(), "{}", control.path);
                for word in words {
                    assert!(!word.contains(['/', '\\', '{', '[', '\n']) && !word.contains(".."), "{word}");
                    assert!(!word.ends_with(".yaml") && !word.ends_with(".csv"), "{word}");
                }
            }
            assert!(control.text(&json!({"a": 1})).is_err() && control.text(&json!("/etc/passwd")).is_err());
        }
    }

    spectra_core::register!(spectra_lens::CoatingEntry, "of-a-plugin": (), |_, _| Ok(Box::new(Coating::Bare)));

    #[test]
    fn coatings_whose_name_alone_stands_for_them_can_be_chosen() {
        let coating = of(&controls(SCENE), "lens.coating");
        let registered = ["bare", "ideal", "of-a-plugin", "single-layer", "three-layer"];
        assert_eq!(coating.kind, Kind::Choice(registered.map(str::to_owned).into()));
    }

    #[test]
    fn each_control_that_is_turned_to_its_own_value_leaves_the_scene_as_it_is() {
        use spectra_session::{Session, SessionOptions};
        let mut session =
            Session::open("biotar-ortho".as_ref(), &[], SessionOptions::default()).expect("a bundled scene");
        let all = of_scene(session.scene().params.node());
        let mut turned = 0;
        for control in all.iter().filter(|control| !control.value.is_null()) {
            let text = control.text(&control.value).unwrap_or_else(|why| panic!("{}: {why}", control.path));
            session.change(&text).unwrap_or_else(|error| panic!("{text}: {error}"));
            turned += 1;
        }
        assert!(turned >= 9, "{turned} controls");
    }
}
