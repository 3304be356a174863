//! `spectra check`: every fault of scenes, nothing rendered.

use crate::arguments::Check;
use crate::console;
use crate::outcome::{BAD_INPUT, DONE, Outcome};
use serde_json::json;
use spectra_core::Isa;
use spectra_core::params::{Fault, Faults};
use spectra_render::Renderer;
use spectra_scene::{Scene, diagnostics};
use std::path::Path;

/// Checks all scenes; a faulty one does not keep the others from being looked at.
pub(crate) fn check(arguments: &Check, isa: Isa) -> Outcome {
    let mut results = Vec::new();
    let mut faulty = 0_usize;
    for path in &arguments.scenes {
        let result = check_one(path, &arguments.set.overrides, isa);
        faulty += usize::from(result.is_err());
        if arguments.json {
            let (faults, warnings) = match &result {
                Ok(warnings) => (json!([]), warnings.clone()),
                Err(faults) => (diagnostics::to_json(faults), Vec::new()),
            };
            results.push(json!({ "scene": path.display().to_string(), "ok": result.is_ok(), "faults": faults, "warnings": warnings }));
            continue;
        }
        match &result {
            Ok(warnings) => {
                for warning in warnings {
                    console::warning(&format!("{}: {warning}", path.display()));
                }
                console::out(&format!("{}: good\n", path.display()))?;
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

/// The warnings of a good scene, or all faults.
fn check_one(path: &Path, overrides: &[String], isa: Isa) -> Result<Vec<String>, Faults> {
    let scene: Scene = spectra_scene::load(path, overrides)?;
    // What shows only once the stages are put together, such as a lens without any aperture.
    Renderer::new(&scene, isa).map_err(|error| Fault::new(format!("{}: {error}", path.display())))?;
    Ok(scene.warnings)
}
