//! `spectra lens import`.

use super::arguments::LensImport;
use super::exchanged::{deliver, target};
use crate::console;
use crate::outcome::{Failure, Outcome};
use spectra_core::resources::Resources;
use spectra_exchange::{Format, MAX_BYTES, read, yaml};
use spectra_scene::FileResources;
use std::path::Path;

/// Makes a lens file of one of another program.
pub(crate) fn import(arguments: &LensImport) -> Outcome {
    let name = arguments.file.display().to_string();
    let Some(format) = Format::of_name(&name) else {
        return Err(Failure::Input(format!("{name}: unknown file extension; .zmx, .seq and .csv can be read")));
    };
    let output = target(arguments.output.as_deref(), &arguments.file, arguments.force)?;
    let resources = FileResources::beside(Path::new(""));
    let file = resources
        .read(&name, &[], &[], MAX_BYTES)
        .map_err(|error| Failure::Input(format!("{name}: cannot be read: {error}")))?;
    let lens = read(format, &name, &file.bytes)?;
    let short = arguments.file.file_name().map(|name| name.to_string_lossy().into_owned());
    let text = yaml::write(&lens, short.as_deref());
    let title = if lens.name.is_empty() { name.clone() } else { lens.name.clone() };
    let code = deliver(&title, lens.surfaces().count(), output, text.as_bytes(), &lens.left_out, arguments.json)?;
    // A file that was written and cannot be loaded: better told now.
    if let Err(faults) = spectra_lens::load(&name, &resources) {
        console::warning("the lens file must be completed before it can be used:");
        console::faults(&faults);
    }
    Ok(code)
}
