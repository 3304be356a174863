//! `spectra schema`: JSON Schemas, for editors and validators.

use crate::arguments::SchemaOf;
use crate::console;
use crate::outcome::{DONE, Outcome};
use spectra_scene::{FileKind, file_schema};

/// Writes the JSON Schema of a kind of file to standard output.
pub(crate) fn schema(arguments: &SchemaOf) -> Outcome {
    let kind = FileKind::ALL.into_iter().find(|kind| kind.name() == arguments.kind).unwrap_or(FileKind::Scene);
    console::pretty_json(&file_schema(kind))?;
    Ok(DONE)
}
