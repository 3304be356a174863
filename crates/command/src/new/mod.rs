//! `spectra new`: creates a plugin, a scene, a lens or a film to start from, which works without changes.

mod arguments;
mod files;
mod film;
mod name;
mod plugin;

pub(crate) use arguments::NewArguments;

use crate::console;
use crate::outcome::{DONE, Failure, Outcome};
use crate::sources::Unpack;
use arguments::{NewCommand, NewFile};
use files::{Folder, filled};
use spectra_core::params::Fault;
use std::path::Path;

const SCENE: &str = include_str!("templates/scene.yaml");
const LENS: &str = include_str!("templates/lens.yaml");

/// Creates what the arguments name, and prints the next steps.
pub(crate) fn new(arguments: &NewArguments, unpack: Unpack) -> Outcome {
    match &arguments.command {
        NewCommand::Plugin(arguments) => plugin::plugin(arguments, unpack),
        NewCommand::Scene(arguments) => {
            let path = file(arguments, SCENE)?;
            console::out(&format!("{path} is ready; next:\n  spectra check {path}\n  spectra run {path}\n"))?;
            Ok(DONE)
        }
        NewCommand::Lens(arguments) => {
            let path = file(arguments, LENS)?;
            let drawing = path.replace(".yaml", ".svg");
            console::out(&format!(
                "{path} is ready; next:\n  spectra lens info {path}\n  spectra lens draw {path} -o {drawing}\n"
            ))?;
            Ok(DONE)
        }
        NewCommand::Film(arguments) => film::film(arguments),
    }
}

/// Writes a file from a template; returns its path as a user would type it.
fn file(arguments: &NewFile, template: &str) -> Result<String, Failure> {
    let name = arguments.name.strip_suffix(".yaml").unwrap_or(&arguments.name);
    written(name, &arguments.path, &filled(template, name))
}

/// Writes a text as `NAME.yaml` into a folder; returns its path as a user would type it. Fails if the file exists.
fn written(name: &str, folder: &Path, text: &str) -> Result<String, Failure> {
    name::check(name)?;
    let path = folder.join(format!("{name}.yaml"));
    if path.exists() {
        let fault = Fault::new(format!("{} already exists", path.display()));
        return Err(fault.hint("choose another name, or remove it first").into());
    }
    Folder::must_exist(folder)?;
    spectra_files::write_atomically(&path, |file| Ok(std::io::Write::write_all(file, text.as_bytes())?))?;
    Ok(files::typed(&path))
}
