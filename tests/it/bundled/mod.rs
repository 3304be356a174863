//! Tests that every bundled scene keeps the promise of its head comment. Small pictures are checked with a formula or with a
//! comparison that the promise makes, and no scene may cause a warning.

mod charts;
mod colors;
mod lamps;
mod plane;
mod points;
mod prisms;
mod streets;
mod suns;
mod surfaces;
mod taken;

use crate::common::{repository, run, shown, text, together};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use taken::{Take, Taken};

/// Scenes that may cause a warning when they are loaded, and why.
const EXCEPTIONS: [(&str, &str); 0] = [];

/// Scenes that may cause a warning when they are rendered, and why.
const EXCEPTIONS_OF_RENDER: [(&str, &str); 1] =
    [("bench/sampling-point-fl11-ortho", "a point lights only a spot of the film, and the rest stays dark")];

/// The promise of a scene.
pub struct Promise {
    /// Name of the scene, below `scenes`.
    pub scene: &'static str,
    /// Pictures that show whether the promise is kept.
    pub pictures: &'static [Take],
    /// Text of the promise, in the words of the scene where possible.
    pub says: &'static str,
    /// Measures the pictures and compares the figures with the promise.
    pub held: fn(&[Taken]) -> Vec<Found>,
}

/// A measured figure, and whether it is as promised.
pub struct Found {
    what: String,
    is_kept: bool,
}

impl Found {
    /// Returns a figure that must be within this relative error.
    pub fn near(what: &str, found: f64, wanted: f64, share: f64) -> Self {
        Self::within(what, found, wanted, share * wanted.abs())
    }

    /// Returns a figure that must be within this absolute error.
    pub fn within(what: &str, found: f64, wanted: f64, error: f64) -> Self {
        Self {
            what: format!("{what} {found:.4} ({wanted:.4} +- {error:.4})"),
            is_kept: (found - wanted).abs() <= error,
        }
    }

    pub fn above(what: &str, found: f64, least: f64) -> Self {
        Self { what: format!("{what} {found:.4} (above {least:.4})"), is_kept: found > least }
    }

    pub fn below(what: &str, found: f64, most: f64) -> Self {
        Self { what: format!("{what} {found:.4} (below {most:.4})"), is_kept: found < most }
    }

    pub fn is(what: &str, is_kept: bool) -> Self {
        Self { what: what.to_owned(), is_kept }
    }
}

/// All promises, by theme.
const ALL: [&[Promise]; 10] = [
    colors::FILMS,
    colors::EYES,
    prisms::PRISMS,
    charts::EDGES,
    charts::SHARP,
    surfaces::SURFACES,
    points::POINTS,
    lamps::LAMPS,
    streets::STREETS,
    suns::SUNS,
];

/// Renders the pictures of these promises and checks that the promises are kept.
fn hold(promises: &[Promise]) {
    let wrong: Vec<String> = together(promises, kept).concat();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Returns what is wrong about a promise; empty if it is kept.
fn kept(promise: &Promise) -> Vec<String> {
    let Promise { scene, pictures, says, held } = promise;
    let taken: Vec<Taken> = pictures.iter().map(|take| Taken::of(scene, take)).collect();
    let is_exception = EXCEPTIONS.iter().chain(&EXCEPTIONS_OF_RENDER).any(|(name, _)| name == scene);
    let said: Vec<&String> = taken.iter().flat_map(|taken| &taken.said).collect();
    let mut wrong = Vec::new();
    if said.is_empty() == is_exception {
        wrong.push(format!("{scene}: warnings for small pictures: {said:?}"));
    }
    for found in held(&taken) {
        println!("{scene}: {}", found.what);
        if !found.is_kept {
            wrong.push(format!("{scene} promises: {says}; found: {}", found.what));
        }
    }
    wrong
}

/// Returns the files of all scenes with their names below `scenes`.
fn scenes() -> Vec<(String, PathBuf)> {
    let root = repository("scenes");
    let files = |folder: &Path| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).expect("a folder");
        entries.map(|entry| entry.expect("readable").path()).collect()
    };
    let mut all = files(&root);
    let folders: Vec<PathBuf> = all.iter().filter(|path| path.is_dir()).cloned().collect();
    all.extend(folders.iter().flat_map(|folder| files(folder)));
    all.retain(|path| path.extension().is_some_and(|ending| ending == "yaml"));
    let named = |path: PathBuf| {
        let below = path.strip_prefix(&root).expect("below").with_extension("");
        (shown(&below).replace('\\', "/"), path)
    };
    all.into_iter().map(named).collect()
}

#[test]
fn every_scene_promises_something() {
    let there: BTreeSet<String> = scenes().into_iter().map(|(name, _)| name).collect();
    let held: BTreeSet<String> = ALL.iter().flat_map(|all| all.iter()).map(|p| p.scene.to_owned()).collect();
    let (more, fewer) = (there.difference(&held), held.difference(&there));
    let (more, fewer): (Vec<&String>, Vec<&String>) = (more.collect(), fewer.collect());
    assert!(more.is_empty(), "scenes without a promise: {more:?}");
    assert!(fewer.is_empty(), "promises of scenes that do not exist: {fewer:?}");
}

/// Checks the scenes unchanged, at their full size.
#[test]
fn nothing_is_said_about_any_scene() {
    let said = |(name, path): &(String, PathBuf)| {
        let output = run(&["check", shown(path)]);
        let (code, said) = (output.status.code(), text(&output.stderr));
        let is_exception = EXCEPTIONS.iter().any(|(scene, _)| scene == name);
        (code != Some(0) || said.contains("warning") != is_exception).then(|| format!("{name}: {code:?}\n{said}"))
    };
    let wrong: Vec<String> = together(&scenes(), said).into_iter().flatten().collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}
