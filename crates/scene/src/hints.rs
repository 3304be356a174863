//! Hints that need the whole scene: a file in the wrong place, a section nested in another one, a section that is a bare name.
//! Also sorts the faults for display.

use crate::bundled::{self, Bundled};
use crate::mistake_hints;
use spectra_core::names::nearest;
use spectra_core::params::{Fault, Faults, Node, Params, SourceFile, Value};
use std::path::Path;
use std::sync::Arc;

/// Sections of a scene that users may nest in another section by mistake.
const SECTIONS: [&str; 8] = ["source", "wavelengths", "lens", "imager", "film", "render", "output", "spectra"];

/// Kinds of YAML files that the program reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FileIs {
    Scene,
    Lens,
    Stock,
}

impl FileIs {
    /// Returns the kind of file that a tree is, judged by its keys; `None` if they do not tell.
    fn of(node: &Node) -> Option<Self> {
        let has = |key: &str| node.get(key).is_some();
        if has("surfaces") {
            Some(Self::Lens)
        } else if has("layers") && !has("source") {
            Some(Self::Stock)
        } else if ["source", "lens", "imager", "film", "render", "output"].iter().filter(|key| has(key)).count() >= 2 {
            Some(Self::Scene)
        } else {
            None
        }
    }

    const fn noun(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Lens => "lens",
            Self::Stock => "film stock",
        }
    }
}

/// Returns a fault without a place if the file is of a different kind from the one wanted.
pub(crate) fn other_file(node: &Node, wanted: FileIs) -> Option<Fault> {
    let found = FileIs::of(node).filter(|found| *found != wanted)?;
    let name = &node.file.name;
    let fault = Fault::new(format!("`{name}` is a {}, not a {}", found.noun(), wanted.noun()));
    Some(fault.hint(match found {
        FileIs::Scene => format!("name a {} here; a scene is rendered by `spectra run {name}`", wanted.noun()),
        FileIs::Lens => format!("a scene names a lens under `lens: {{file: {name}}}`; `spectra lens info {name}` shows it"),
        FileIs::Stock => {
            format!("a scene names a stock under `film: {{stock: {name}, exposure: 1/60 s}}`; `spectra film info {name}` shows it")
        }
    }))
}

/// Improves the faults of a scene file that cannot be read: names a directory, a similar file or a similar bundled scene.
pub(crate) fn unreadable(faults: Faults, path: &Path) -> Faults {
    let name = path.display();
    let names = |folder: &Path| -> Vec<String> {
        let entries = std::fs::read_dir(folder).into_iter().flatten().take(10_000).flatten();
        let mut names: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
        names.retain(|name| name.ends_with(".yaml") || name.ends_with(".yml"));
        names.sort_unstable();
        names
    };
    if path.is_dir() {
        let inside = names(path);
        let hint = match inside.first() {
            Some(first) => format!("name a scene in it, such as `{}`", path.join(first).display()),
            None => "name a scene file".to_owned(),
        };
        return Fault::new(format!("`{name}` is a directory, not a scene file")).hint(hint).into();
    }
    if path.exists() {
        return faults;
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let wanted = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let typed = path.to_string_lossy();
    let several = bundled::scene_file(&typed).err().unwrap_or_default();
    let scenes = Bundled::Scene.names();
    let stem = wanted.strip_suffix(".yaml").unwrap_or(&wanted);
    let (beside, bundled) = (names(folder), scenes.iter().map(String::as_str));
    // A nearby file is named with its folder, a bundled scene by its name alone: both work as they are shown.
    let near = match nearest(&wanted, beside.iter().map(String::as_str)) {
        Some(near) => Some(path.with_file_name(near).display().to_string()),
        None => nearest(stem, bundled).map(str::to_owned),
    };
    let hint = if !several.is_empty() {
        format!("which one? {}", list(&several))
    } else if let Some(near) = near.filter(|near| *near != typed) {
        format!("did you mean `{near}`?")
    } else if let Some(other) = bundled::other_kind(&typed, Bundled::Scene) {
        other
    } else {
        "name a scene file, or a bundled scene such as `gray-card`; `spectra list scene` shows all".to_owned()
    };
    let missing = if is_file_name(&typed) { "no such file" } else { "no scene or file of this name" };
    Fault::new(format!("`{name}`: {missing}")).hint(hint).into()
}

/// Returns whether a name is written like a file name instead of the name of something bundled.
pub(crate) fn is_file_name(name: &str) -> bool {
    [".yaml", ".yml", ".zmx", ".seq", ".csv"].iter().any(|ending| name.to_ascii_lowercase().ends_with(ending))
}

fn list(names: &[String]) -> String {
    let shown: Vec<String> = names.iter().take(8).map(|name| format!("`{name}`")).collect();
    shown.join(", ") + if names.len() > shown.len() { " ..." } else { "" }
}

/// Adds hints from the whole scene to its faults and sorts them: those of the scene file in its order, then those of other files,
/// one file after another.
pub(crate) fn with_hints(faults: Faults, scene: &Params) -> Faults {
    let mut all: Vec<Fault> = faults.into_iter().map(|fault| advise(fault, scene)).collect();
    // Lists files in the order in which they appear, the scene's own first.
    let mut files: Vec<Arc<SourceFile>> = vec![Arc::clone(&scene.node().file)];
    for (file, _) in all.iter().filter_map(|fault| fault.place.as_ref()) {
        if !files.contains(file) {
            files.push(Arc::clone(file));
        }
    }
    all.sort_by_key(|fault| match &fault.place {
        Some((file, span)) => (files.iter().position(|f| f == file).unwrap_or(files.len()), span.offset),
        None => (files.len(), 0),
    });
    Faults(all)
}

/// Returns an example of a film section for a stock.
fn film_of(stock: &str) -> String {
    format!("{{stock: {stock}, exposure: 1/60 s}}")
}

fn advise(fault: Fault, scene: &Params) -> Fault {
    if fault.message.starts_with("missing key") {
        let example = match fault.path.as_str() {
            "spectra" => "add `spectra: 1` as the first line",
            "source" => "add `source: {kind: chart, chart: resolution, distance: 2 m, width: 1.5 m}`",
            "lens" => "add `lens: {file: zeiss-biotar-50-f1.4}`",
            "imager" => "add `imager: {kind: film, format: 135, resolution: [960, 640]}`",
            _ => return fault,
        };
        return fault.hint(example);
    }
    if fault.message.starts_with("unknown key")
        && let Some((section, key)) = fault.path.split_once('.')
        && SECTIONS.contains(&section)
        && SECTIONS.contains(&key)
        && scene.get(key).is_none()
    {
        let hint = format!("`{key}` is a section of its own: start it in the same column as `{section}:`");
        return fault.hint(hint);
    }
    // A bare name is read as a kind. In place of a film it is meant as the name of a stock.
    if fault.path.starts_with("film")
        && fault.path.ends_with(".kind")
        && fault.message.starts_with("unknown")
        && let Some(Value::String(name)) = scene.node().at_path(fault.path.trim_end_matches(".kind")).map(|n| &n.value)
    {
        let example = film_of(name);
        let is_alone = fault.path == "film.kind";
        return fault.hint(if is_alone {
            format!("write a film stock as `film: {example}`")
        } else {
            format!("in a list of films, write a stock as `{example}`")
        });
    }
    if fault.path == "film.stock"
        && let Some(Value::Seq(stocks)) = scene.node().at_path("film.stock").map(|node| &node.value)
    {
        let films: Vec<String> = stocks.iter().filter_map(Node::as_str).map(film_of).collect();
        return fault.hint(format!("write several films at once as a list: `film: [{}]`", films.join(", ")));
    }
    match mistake_hints::hint(&fault, scene) {
        Some(hint) => fault.hint(hint),
        None => fault,
    }
}
