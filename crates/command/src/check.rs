//! `spectra check`: every fault of scenes, nothing rendered.

use crate::arguments::Check;
use crate::console;
use crate::outcome::{BAD_INPUT, DONE, Failure, Outcome};
use crate::run;
use serde_json::json;
use spectra_core::Isa;
use spectra_core::params::{Fault, Faults, Warning};
use spectra_scene::{SeriesKind, diagnostics};
use std::path::Path;

/// Checks all scenes; a faulty one does not keep the others from being looked at.
pub(crate) fn check(arguments: &Check, isa: Isa) -> Outcome {
    let mut results = Vec::new();
    let mut faulty = 0_usize;
    for path in &arguments.scenes {
        let result = check_one(path, &arguments.set.overrides, isa);
        faulty += usize::from(result.is_err());
        if arguments.json {
            let scene = path.display().to_string();
            let mut said = match &result {
                Ok(good) => {
                    json!({ "scene": scene, "ok": true, "faults": [], "warnings": diagnostics::warnings_to_json(&good.warnings) })
                }
                Err(faults) => {
                    json!({ "scene": scene, "ok": false, "faults": diagnostics::to_json(faults), "warnings": [] })
                }
            };
            if let Some(pictures) = result.as_ref().ok().and_then(|good| good.pictures) {
                said["pictures"] = pictures.into();
            }
            results.push(said);
            continue;
        }
        match &result {
            Ok(good) => {
                for warning in &good.warnings {
                    console::said(warning, Some(path));
                }
                let pictures =
                    good.pictures.map_or(String::new(), |n| format!(", {n} picture{}", if n == 1 { "" } else { "s" }));
                console::out(&format!("{}: good{pictures}\n", path.display()))?;
            }
            Err(faults) => console::faults(faults),
        }
    }
    if arguments.json {
        console::pretty_json(&json!({ "scenes": results }))?;
    } else if faulty > 0 && arguments.scenes.len() > 1 {
        console::error(&format!("{faulty} of {} scenes cannot be rendered", arguments.scenes.len()));
    }
    Ok(if faulty > 0 { BAD_INPUT } else { DONE })
}

/// A scene in which nothing is wrong.
struct Good {
    warnings: Vec<Warning>,
    /// How many pictures a sweep or an animation has.
    pictures: Option<usize>,
}

/// The warnings of a good scene, or all faults.
fn check_one(path: &Path, overrides: &[String], isa: Isa) -> Result<Good, Faults> {
    let series = spectra_scene::load_series(path, overrides)?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let all: Vec<usize> = (0..series.count()).collect();
    let of_each = run::checked(&series, &all, isa, threads, &|_, scene| Ok(scene.warnings));
    let of_each = of_each.map_err(|failure| match failure {
        Failure::Faults(faults) => faults,
        // What shows only once the stages are put together, such as a lens without any aperture.
        Failure::Input(text) | Failure::Failed(text) => Fault::new(format!("{}: {text}", path.display())).into(),
        Failure::ReaderGone => Faults::new(),
    })?;
    let mut warnings: Vec<Warning> = Vec::new();
    for warning in series.warnings().iter().chain(of_each.iter().flatten()) {
        if !warnings.contains(warning) {
            warnings.push(warning.clone());
        }
    }
    Ok(Good { warnings, pictures: (series.kind() != SeriesKind::Single).then_some(all.len()) })
}
