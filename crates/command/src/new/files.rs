//! Fills templates and writes all files of a folder, or none.

use super::name::camel_case;
use crate::outcome::Failure;
use spectra_core::params::Fault;
use spectra_files::write_folder;
use std::path::{Path, PathBuf};

/// Returns a template with `my-stage` and `MyStage` replaced by a name.
pub(super) fn filled(template: &str, name: &str) -> String {
    template.replace("my-stage", name).replace("MyStage", &camel_case(name))
}

/// Returns a path as a user would type it: without a leading `./`, and in quotes if a shell needs them.
pub(super) fn typed(path: &Path) -> String {
    let plain: PathBuf = path.components().filter(|c| *c != std::path::Component::CurDir).collect();
    let text = plain.display().to_string();
    let safe = |c: char| c.is_alphanumeric() || "-_./\\:+,@".contains(c);
    if text.chars().all(safe) { text } else { format!("'{}'", text.replace('\'', r"'\''")) }
}

/// A folder to write, with its files.
pub(super) struct Folder {
    path: PathBuf,
    files: Vec<(&'static str, String)>,
}

impl Folder {
    pub(super) fn new(path: PathBuf) -> Self {
        Self { path, files: Vec::new() }
    }

    /// Adds a file; its name may include folders.
    pub(super) fn file(&mut self, name: &'static str, text: String) {
        self.files.push((name, text));
    }

    /// Fails if the folder to create something in does not exist.
    pub(super) fn must_exist(parent: &Path) -> Result<(), Failure> {
        if parent.is_dir() {
            return Ok(());
        }
        Err(Fault::new(format!("--path {}: there is no such folder", parent.display())).hint("create it first").into())
    }

    /// Writes the whole folder, or nothing.
    pub(super) fn write(self) -> Result<(), Failure> {
        write_folder(&self.path, &self.files).map_err(|error| Failure::Failed(error.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_typed_as_people_do() {
        assert_eq!([typed(Path::new("./a/b.yaml")), typed(Path::new("a b"))], ["a/b.yaml", "'a b'"]);
    }
}
