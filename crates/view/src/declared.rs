//! What all scenes have in common: the parameters that the stages declare, and the names from which a page may choose.

use serde_json::{Value, json};
use spectra_core::registry::{self, Listed, Parameter, Stage};
use spectra_film::stock::{Process, Stock};
use spectra_lens::Coating;
use spectra_scene::bundled::Bundled;
use spectra_scene::{FileKind, FileResources, file_documentation, shared_documentation};
use spectra_spectrum::bundled_spectra;
use std::path::Path;
use std::sync::LazyLock;

/// Keys of which the value is the name of a light.
const LIGHTS: [&str; 3] = ["illuminant", "lamp", "light"];

/// Sections of a scene, each with the kind of stage that it holds.
pub(crate) const SECTIONS: [(&str, &str); 5] = [
    ("film", "film"),
    ("imager", "imager"),
    ("imager.response", "response"),
    ("source", "source"),
    ("wavelengths", "wavelengths"),
];

/// The parameters that this program's stages declare. They are the same for every scene, and slow to gather.
pub(crate) struct Declared {
    pub(crate) stages: Vec<(Listed, Vec<Parameter>)>,
    pub(crate) shared: Vec<(&'static str, Vec<Parameter>)>,
    /// Parameters of the sections `lens` and `render`, which hold no stage.
    pub(crate) of_file: Vec<Parameter>,
    /// Names of the coatings that have no required parameters, so that a name alone stands for them.
    coatings: Vec<String>,
}

pub(crate) static DECLARED: LazyLock<Declared> = LazyLock::new(|| {
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
pub(crate) static TILES: LazyLock<Value> = LazyLock::new(|| {
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

/// Returns the names that are allowed as the text at a path; `None` if there is no list of names for it.
pub(crate) fn names(path: &str) -> Option<Vec<String>> {
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
