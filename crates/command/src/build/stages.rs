//! Asks a newly built program for its stages.

use super::plugin::Plugin;
use crate::outcome::Failure;
use serde::Deserialize;
use spectra_core::params::Fault;
use std::path::Path;
use std::process::{Command, Stdio};

/// The parts of `spectra list --json` that are used here.
#[derive(Debug, Deserialize)]
struct Listed {
    stage: String,
    name: String,
    package: String,
}

/// Runs the program and returns the stages of each plugin, as text like "surface `axicon`". Fails if a plugin registers none.
pub(super) fn added(program: &Path, plugins: &[Plugin]) -> Result<Vec<Vec<String>>, Failure> {
    let output = Command::new(program).args(["list", "--json"]).stdin(Stdio::null()).output();
    let output = output.map_err(|error| Failure::Failed(format!("{} cannot be run: {error}", program.display())))?;
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stderr);
        let text = text.trim().trim_start_matches("error: ");
        let fault = Fault::new(format!("the program was built, but does not start: {text}"));
        return Err(fault.hint("the name of each stage must be unique: rename it in `register!`").into());
    }
    let listed: Vec<Listed> = serde_json::from_slice(&output.stdout)
        .map_err(|error| Failure::Failed(format!("the output of {} cannot be read: {error}", program.display())))?;
    let mut faults = Vec::new();
    let mut all = Vec::new();
    for plugin in plugins {
        let own = listed.iter().filter(|l| l.package == plugin.package);
        let own: Vec<String> = own.map(|l| format!("{} `{}`", l.stage, l.name)).collect();
        if own.is_empty() {
            let fault = Fault::new(format!("the crate `{}` was built in, but registers no stage", plugin.package));
            faults.push(fault.hint(format!(
                "`spectra_core::register!(...)` is missing, or is in a file that {} does not include with `mod`",
                plugin.folder.join("src/lib.rs").display()
            )));
        }
        all.push(own);
    }
    if faults.is_empty() { Ok(all) } else { Err(spectra_core::params::Faults(faults).into()) }
}
