//! `spectra lens import`: converts a lens file from another program.

use super::arguments::LensImport;
use super::conversion::{deliver, target};
use crate::console;
use crate::glass::own_glasses;
use crate::outcome::{Failure, Outcome};
use spectra_core::resources::Resources;
use spectra_exchange::{Format, MAX_BYTES, UserCatalog, read_with, yaml};
use spectra_scene::FileResources;
use std::path::{Component, Path, absolute};

/// Converts a lens file of another program to a lens file of `spectra`.
pub(crate) fn import(arguments: &LensImport) -> Outcome {
    let name = arguments.file.display().to_string();
    let Some(format) = Format::of_name(&name) else {
        return Err(Failure::Input(format!("{name}: unknown file extension; .zmx, .seq, .csv and .txt can be read")));
    };
    let output = target(arguments.output.as_deref(), &arguments.file, arguments.force)?;
    let resources = FileResources::beside(Path::new(""));
    let file = resources
        .read(&name, &[], &[], MAX_BYTES)
        .map_err(|error| Failure::Input(format!("{name}: cannot be read: {error}")))?;
    let mut own = Vec::new();
    for path in &arguments.own.files {
        own.push(UserCatalog { file: seen_from(output, path), glasses: own_glasses(path)? });
    }
    let lens = read_with(format, &name, &file.bytes, &own)?;
    let short = arguments.file.file_name().map(|name| name.to_string_lossy().into_owned());
    let text = yaml::write(&lens, short.as_deref());
    let title = if lens.name.is_empty() { name.clone() } else { lens.name.clone() };
    let code = deliver(&title, lens.surfaces().count(), output, text.as_bytes(), &lens.left_out, arguments.json)?;
    // If the converted file cannot be loaded, the user should know now.
    let written = output.unwrap_or(&arguments.file).display().to_string();
    match spectra_lens::load(&written, &resources) {
        Err(faults) => {
            console::warning("the lens file must be completed before use:");
            console::faults(&faults);
        }
        Ok(lens) => lens.glass_warnings().iter().for_each(|doubt| console::warning(doubt)),
    }
    Ok(code)
}

/// Returns the path of `file` as the lens file `lens` should name it: relative to its own folder. A lens file on standard output (`None`)
/// names it as given.
fn seen_from(lens: Option<&Path>, file: &Path) -> String {
    let plain = || file.display().to_string();
    let Some(lens) = lens else { return plain() };
    let (Ok(lens), Ok(file)) = (absolute(lens), absolute(file)) else { return plain() };
    let folder: Vec<Component<'_>> = lens.parent().into_iter().flat_map(Path::components).collect();
    let parts: Vec<Component<'_>> = file.components().collect();
    let common = folder.iter().zip(&parts).take_while(|(a, b)| a == b).count();
    if common == 0 {
        // The files are on different drives.
        return file.display().to_string();
    }
    let up = std::iter::repeat_n("..".into(), folder.len() - common);
    let down = parts[common..].iter().map(|part| part.as_os_str().to_string_lossy());
    up.chain(down).collect::<Vec<_>>().join("/")
}
