//! Filled templates, written all or not at all.

use super::name::camel_case;
use crate::outcome::Failure;
use spectra_core::params::Fault;
use std::io;
use std::path::{Path, PathBuf};

/// A template with a name in place of `my-stage` and `MyStage`.
pub(super) fn filled(template: &str, name: &str) -> String {
    template.replace("my-stage", name).replace("MyStage", &camel_case(name))
}

/// A path as a person types it: without `./` before it, in quotes where a shell needs them.
pub(super) fn typed(path: &Path) -> String {
    let plain: PathBuf = path.components().filter(|c| *c != std::path::Component::CurDir).collect();
    let text = plain.display().to_string();
    let safe = |c: char| c.is_alphanumeric() || "-_./\\:+,@".contains(c);
    if text.chars().all(safe) { text } else { format!("'{}'", text.replace('\'', r"'\''")) }
}

/// Files that are to lie in a folder.
pub(super) struct Folder {
    path: PathBuf,
    files: Vec<(&'static str, String)>,
}

impl Folder {
    pub(super) fn new(path: PathBuf) -> Self {
        Self { path, files: Vec::new() }
    }

    /// Adds a file; the name may have folders before it.
    pub(super) fn file(&mut self, name: &'static str, text: String) {
        self.files.push((name, text));
    }

    /// Says so where there is no such folder to make something in.
    pub(super) fn must_exist(parent: &Path) -> Result<(), Failure> {
        if parent.is_dir() {
            return Ok(());
        }
        Err(Fault::new(format!("--path {}: there is no such folder", parent.display())).hint("create it first").into())
    }

    /// Writes all of it under another name, then gives it its own.
    pub(super) fn write(self) -> Result<(), Failure> {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let temporary = self.path.with_file_name(format!(".{name}.{}.tmp", std::process::id()));
        let written = self.write_to(&temporary).and_then(|()| {
            // Renaming would take the place of an empty folder that somebody has made meanwhile.
            if self.path.exists() {
                Err(io::ErrorKind::AlreadyExists.into())
            } else {
                std::fs::rename(&temporary, &self.path)
            }
        });
        written.map_err(|error| {
            // What removal says adds nothing to the fault that is reported.
            let _ = std::fs::remove_dir_all(&temporary);
            Failure::Failed(format!("{}: cannot be written: {error}", self.path.display()))
        })
    }

    fn write_to(&self, folder: &Path) -> io::Result<()> {
        std::fs::create_dir(folder)?;
        for (name, text) in &self.files {
            let path = folder.join(name);
            std::fs::create_dir_all(path.parent().unwrap_or(folder))?;
            std::fs::write(path, text)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_typed_as_people_do() {
        assert_eq!([typed(Path::new("./a/b.yaml")), typed(Path::new("a b"))], ["a/b.yaml", "'a b'"]);
    }

    #[test]
    fn nothing_is_left_of_what_fails() {
        let parent = tempfile::tempdir().unwrap();
        let mut folder = Folder::new(parent.path().join("x"));
        folder.file("a/b", "text".into());
        folder.file("a", "a folder has that name".into());
        assert!(folder.write().is_err());
        assert_eq!(std::fs::read_dir(parent.path()).unwrap().count(), 0);
    }
}
