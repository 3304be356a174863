//! Assembly of a [`Scene`] from a scene file; all faults are reported together.

use crate::hints::{self, FileIs};
use crate::resources::read_yaml;
use crate::reuse::ReusableStages;
use crate::scene_builder::SceneBuilder;
use crate::{Scene, yaml};
use spectra_core::params::{Fault, Faults, Node, Params, Warnings};
use spectra_core::resources::Resources;
use std::path::Path;

/// Reads the scene file, or the bundled scene of that name if there is no such file.
pub(crate) fn read(path: &Path) -> Result<Node, Faults> {
    if !path.exists()
        && let Ok(bundled) = crate::bundled::scene_file(&path.to_string_lossy())
        && let Some(bytes) = spectra_data::get(&bundled)
    {
        return yaml::parse_bytes(&format!("bundled:{bundled}"), bytes);
    }
    read_yaml(path).map_err(|faults| hints::unreadable(faults, path))
}

/// Returns the scene as written, with the overrides below it as comments. Settings that do not change a picture are left out, so
/// that the record in a picture file does not change with them.
pub(crate) fn record(text: &str, overrides: &[String]) -> String {
    let mut record = text.to_owned();
    if !record.is_empty() && !record.ends_with('\n') {
        record.push('\n');
    }
    for line in overrides.iter().filter(|o| !o.starts_with("render.batch")) {
        record.push_str("# --set ");
        record.push_str(line);
        record.push('\n');
    }
    record
}

/// Assembles all stages of a scene from a tree in which includes, variables and series are already resolved.
///
/// # Errors
/// Every fault of the scene, each with its place.
pub(crate) fn assemble(
    name: &str,
    text: String,
    params: &Params,
    resources: &dyn Resources,
    earlier: ReusableStages<'_>,
) -> Result<Scene, Faults> {
    if let Some(fault) = hints::other_file(params.node(), FileIs::Scene) {
        return Err(Fault { message: fault.message, hint: fault.hint, ..params.fault_here("") }.into());
    }
    let warnings = Warnings::new();
    let builder = SceneBuilder::new(params, resources, &warnings, earlier);
    builder.build(name, text).map_err(|faults| hints::with_hints(faults, params))
}
