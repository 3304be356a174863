//! Runs cargo as a separate program.

use super::metadata::Metadata;
use crate::console;
use crate::outcome::Failure;
use crate::sources::{Sources, plain};
use serde_json::Value;
use spectra_core::params::Fault;
use std::ffi::OsString;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The cargo program, and whether it may use the network.
#[derive(Debug)]
pub(crate) struct Cargo {
    program: OsString,
    offline: bool,
}

impl Cargo {
    /// Finds cargo: `$CARGO`, or the one on the path. Fails if it cannot be run.
    pub(super) fn find(offline: bool) -> Result<Self, Failure> {
        let program = std::env::var_os("CARGO").filter(|p| !p.is_empty()).unwrap_or_else(|| "cargo".into());
        let found = Command::new(&program).arg("--version").stdin(Stdio::null()).output();
        match found {
            Ok(output) if output.status.success() => Ok(Self { program, offline }),
            Ok(output) => Err(Failure::Failed(format!(
                "`{} --version` fails: {}",
                program.display(),
                String::from_utf8_lossy(&output.stderr).trim()
            ))),
            Err(error) => {
                let fault = Fault::new(format!("`{}` cannot be run: {error}", program.display()));
                Err(fault
                    .hint("plugins must be compiled: install Rust (https://rustup.rs), or set CARGO to its cargo")
                    .into())
            }
        }
    }

    fn command(&self, verb: &str, manifest: &Path) -> Command {
        let mut command = Command::new(&self.program);
        // A toolchain file in the plugin's folder applies, as if its author ran cargo there.
        if let Some(folder) = manifest.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            command.current_dir(folder);
        }
        command.arg(verb).arg("--manifest-path").arg(plain(manifest)).stdin(Stdio::null());
        if self.offline {
            command.arg("--offline");
        }
        command
    }

    /// Reads the metadata of a manifest without resolving its dependencies.
    pub(super) fn metadata_alone(&self, manifest: &Path) -> Result<Metadata, String> {
        self.metadata(manifest, &["--no-deps"])
    }

    fn metadata(&self, manifest: &Path, more: &[&str]) -> Result<Metadata, String> {
        let mut command = self.command("metadata", manifest);
        let output = command.args(["--format-version", "1"]).args(more).output().map_err(|error| error.to_string())?;
        if !output.status.success() {
            let text = String::from_utf8_lossy(&output.stderr);
            return Err(text.trim().trim_start_matches("error: ").to_owned());
        }
        serde_json::from_slice(&output.stdout).map_err(|error| format!("its output cannot be read: {error}"))
    }

    /// Resolves the crates of the program at a manifest. Fails if they do not all share one `spectra-core`, that of `sources`.
    pub(super) fn check_graph(&self, program: &Path, sources: &Sources) -> Result<Metadata, Failure> {
        let metadata = self.metadata(program, &["--filter-platform", env!("SPECTRA_TARGET")]).map_err(|text| {
            if text.contains("links to the native library `spectra-core`") || text.contains("links to native library `spectra-core`") {
                let fault = Fault::new(format!("this program would contain two versions of spectra-core\n{text}"));
                return Failure::from(fault.hint(format!(
                    "each would hold some of the stages: a plugin, or a crate it depends on, requires a spectra-core other than {}",
                    crate::version::VERSION
                )));
            }
            let hint = if self.offline {
                "without --offline, cargo can download missing crates"
            } else {
                "cargo could not find a crate that a plugin depends on, or a version of it that suits all of them"
            };
            Fault::new(format!("cargo cannot resolve the program's dependencies\n{text}")).hint(hint).into()
        })?;
        let ours = plain(&sources.crate_folder("crates/core/Cargo.toml"));
        let other = metadata.packages.iter().find(|p| p.name == "spectra-core" && plain(&p.manifest_path) != ours);
        match other {
            None => Ok(metadata),
            Some(other) => {
                let from = other.manifest_path.display();
                let text =
                    format!("a second spectra-core {} would be linked into the program, from {from}", other.version);
                Err(Fault::new(text)
                    .hint("its stages would be missing: a plugin depends on it by path or by git")
                    .into())
            }
        }
    }

    /// Builds the program with the given name, profile and manifest, and returns its executable. Cargo builds in `$CARGO_TARGET_DIR`, or
    /// else in `target`; its messages go to standard error as they come.
    pub(super) fn build(&self, [name, profile]: [&str; 2], [manifest, target]: [&Path; 2]) -> Result<PathBuf, Failure> {
        let mut command = self.command("build", manifest);
        // Messages of the compiler come as JSON, which names the crate, and are shown unchanged.
        let colored = console::stderr_is_colored();
        let format = if colored { "json-diagnostic-rendered-ansi" } else { "json" };
        command.args(["--profile", profile, "--message-format", format]);
        if std::env::var_os("CARGO_TARGET_DIR").is_none_or(|folder| folder.is_empty()) {
            command.arg("--target-dir").arg(target);
        } else if let Some(folder) = std::env::var_os("CARGO_TARGET_DIR") {
            // The path is relative to the user's working folder, not to the generated crate.
            command.arg("--target-dir").arg(std::path::absolute(&folder).unwrap_or_else(|_| folder.into()));
        }
        let failed = |error: std::io::Error| Failure::Failed(format!("cargo cannot be run: {error}"));
        let mut child = command.stdout(Stdio::piped()).spawn().map_err(failed)?;
        let mut report = Report::default();
        for line in child.stdout.take().map(BufReader::new).into_iter().flat_map(BufRead::lines) {
            let Ok(line) = line else { break };
            report.read(&line, name);
        }
        let status = child.wait().map_err(failed)?;
        match report.executable {
            Some(executable) if status.success() => Ok(executable),
            _ if report.faulty.is_empty() => {
                Err(Failure::Failed(format!("cargo could not build the program ({status}); see its output above")))
            }
            _ => Err(Failure::Failed(format!(
                "{} does not compile; see the compiler's output above",
                report.faulty.join(", ")
            ))),
        }
    }
}

/// Result of a build, from the JSON lines that cargo writes.
#[derive(Debug, Default)]
struct Report {
    executable: Option<PathBuf>,
    /// Crates with errors.
    faulty: Vec<String>,
}

impl Report {
    fn read(&mut self, line: &str, program: &str) {
        let Ok(message) = serde_json::from_str::<Value>(line) else { return };
        let target = message["target"]["name"].as_str().unwrap_or_default();
        match message["reason"].as_str() {
            Some("compiler-artifact") if target == program => {
                self.executable = message["executable"].as_str().map(PathBuf::from).or(self.executable.take());
            }
            Some("compiler-message") => {
                if let Some(words) = message["message"]["rendered"].as_str() {
                    console::note(words.trim_end());
                }
                if message["message"]["level"] != "error" {
                    return;
                }
                let name = format!("`{}`", target.replace('_', "-"));
                if !self.faulty.contains(&name) {
                    self.faulty.push(name);
                }
            }
            _ => {}
        }
    }
}
