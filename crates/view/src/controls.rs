//! Controls of the page: one for each number, choice and switch that the scene's stages declare.
//!
//! A page sends numbers, switches and words of a control's own list, never free text. The values for the scene are put together here, so
//! no file path comes from a page.

use crate::control::{Control, Kind};
use crate::declared::{DECLARED, Declared, SECTIONS, names};
use serde_json::{Value, json};
use spectra_core::params::{Node, Value as Written};
use spectra_core::registry::{Parameter, ValueForm};
use spectra_scene::{NO_LENS, Series, SeriesKind};
use spectra_session::Session;

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

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_lens::Coating;
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
