//! Common parts of import and export: protection of existing files, and the list of what was left out.

use crate::console;
use crate::folder::apart;
use crate::formatting::counted;
use crate::outcome::{DONE, Failure, Outcome};
use serde_json::json;
use spectra_exchange::Note;
use spectra_files::write_atomically;
use std::io::Write;
use std::path::Path;

/// Returns the file to write to; `None` means standard output.
///
/// # Errors
/// Fails if the file exists and `force` is not set, or if it is the input file.
pub(super) fn target<'a>(output: Option<&'a Path>, read: &Path, force: bool) -> Result<Option<&'a Path>, Failure> {
    let output = output.filter(|path| *path != Path::new("-"));
    output.map_or(Ok(()), |output| apart(output, &[read]))?;
    if let Some(path) = output
        && !force
        && path.exists()
    {
        return Err(Failure::Input(format!(
            "{} exists: choose another name, or use --force to overwrite it",
            path.display()
        )));
    }
    Ok(output)
}

/// Writes a converted lens and reports what was left out.
pub(super) fn deliver(
    name: &str,
    surfaces: usize,
    output: Option<&Path>,
    bytes: &[u8],
    left_out: &[Note],
    as_json: bool,
) -> Outcome {
    match output {
        Some(path) => write_atomically(path, |file| Ok(file.write_all(bytes)?))?,
        None => console::out(&String::from_utf8_lossy(bytes))?,
    }
    if as_json {
        let notes: Vec<_> = left_out
            .iter()
            .map(|note| {
                json!({
                    "line": (note.line > 0).then_some(note.line),
                    "text": note.text,
                    "alters_light": note.alters,
                })
            })
            .collect();
        console::pretty_json(&json!({
            "lens": name,
            "surfaces": surfaces,
            "written": output.map(|path| path.display().to_string()),
            "not_carried": notes,
        }))?;
        return Ok(DONE);
    }
    if !left_out.is_empty() {
        console::note("not converted (! marks what changes the path of light):");
        for note in left_out {
            console::note(&format!("  {} {note}", if note.alters { "!" } else { "-" }));
        }
    }
    if let Some(path) = output {
        console::note(&format!("wrote {}: {name}, {}", path.display(), counted(surfaces as u64, "surface")));
    }
    Ok(DONE)
}
