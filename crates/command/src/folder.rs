//! Where results are written: a folder, or a single picture file.

use crate::outcome::Failure;
use spectra_core::params::Fault;
use spectra_core::sink::{Content, Sink, WriteFault};
use spectra_files::{self as files, leftover};
use spectra_session::{Folder, Names};
use std::collections::BTreeSet;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// Output target named by `--output`: a folder, or a single picture.
#[derive(Clone, Debug)]
pub(crate) struct Target {
    /// Folder that all files are written to.
    pub folder: PathBuf,
    /// Names of the files in the folder.
    pub names: Names,
}

impl Target {
    /// Interprets `--output`: a name with the ending of a picture is a single picture, any other name is a folder.
    ///
    /// # Errors
    /// Fails if a file exists there whose name is not that of a picture, or if `output` is `-` (standard output).
    pub(crate) fn of(output: &Path) -> Result<Self, Failure> {
        if output == Path::new("-") {
            let text = "--output: pictures cannot be written to standard output";
            return Err(Fault::new(text).hint("name a picture, such as out.png, or a folder").into());
        }
        let whole = Self { folder: output.to_owned(), names: Names::of_scene() };
        if output.is_dir() {
            return Ok(whole);
        }
        if let Some(names) = Names::of_picture(output) {
            let folder = output.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
            return Ok(Self { folder: folder.to_owned(), names });
        }
        if output.is_file() {
            return Err(Failure::Failed(format!(
                "cannot write to `{}`: that is a file; name a folder, or a picture that ends in .png, .tiff, .exr or .dng",
                output.display()
            )));
        }
        Ok(whole)
    }
}

impl Sink for Target {
    fn file(&self, name: &str, content: Content<'_>) -> Result<(), WriteFault> {
        // The folder may have been deleted since the render began. If it cannot be created, writing the file reports the error.
        let _ = std::fs::create_dir_all(&self.folder);
        files::DiskFolder(self.folder.clone()).file(name, content)
    }
}

impl Folder for Target {
    fn prepare(&self, _: &str, files: &[&str]) -> Result<(), Fault> {
        std::fs::create_dir_all(&self.folder).map_err(|error| refused(&self.folder, &error))?;
        if let Some(path) = files.iter().map(|file| self.folder.join(file)).find(|path| path.is_dir()) {
            return Err(refused(&path, &"a folder of that name exists"));
        }
        // Permissions, read-only disks and quotas show only in an attempt to write.
        // Several pictures of a series may try at the same time, so each attempt has a number.
        static ATTEMPTS: AtomicU64 = AtomicU64::new(0);
        let number = ATTEMPTS.fetch_add(1, Relaxed);
        let attempt = self.folder.join(format!(".spectra-{}-{number}.tmp", std::process::id()));
        let written = std::fs::write(&attempt, b"spectra");
        // Even on a full disk the file name was created, so it is always removed.
        let removed = std::fs::remove_file(&attempt);
        written.and(removed).map_err(|error| refused(&self.folder, &error))?;
        // Leftovers are removed once per folder, however many pictures are written to it.
        static SWEPT: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
        if SWEPT.lock().unwrap_or_else(PoisonError::into_inner).insert(self.folder.clone()) {
            leftover::remove_stale_temporaries(&self.folder);
        }
        Ok(())
    }

    fn has(&self, file: &str) -> bool {
        has(&self.folder.join(file))
    }

    fn is(&self, file: &str, path: &Path) -> bool {
        is_same(&self.folder.join(file), path)
    }

    fn is_newer(&self, file: &str, than: &str) -> bool {
        let changed = |name: &str| std::fs::metadata(self.folder.join(name)).and_then(|data| data.modified()).ok();
        changed(file).zip(changed(than)).is_some_and(|(one, other)| one > other)
    }

    fn remove(&self, file: &str) {
        // A file that cannot be removed stays, marked as partial.
        let _ = std::fs::remove_file(self.folder.join(file));
    }

    fn read(&self, file: &str, most: u64) -> Option<Vec<u8>> {
        let path = self.folder.join(file);
        let fits = std::fs::metadata(&path).is_ok_and(|data| data.len() <= most);
        fits.then(|| std::fs::read(path).ok()).flatten()
    }

    fn shown(&self, file: &str) -> String {
        self.folder.join(file).display().to_string()
    }
}

/// Whether a file exists and is not empty. An empty file is usually left over from a failed copy or a full disk.
fn has(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|data| data.is_file() && data.len() > 0)
}

/// Whether both paths lead to the same existing file.
pub(crate) fn is_same(one: &Path, other: &Path) -> bool {
    let real = |path: &Path| std::fs::canonicalize(path).ok();
    real(one).is_some_and(|one| Some(one) == real(other))
}

/// Checks that the output does not overwrite an input file.
///
/// # Errors
/// Fails if `output` is one of the files in `read`.
pub(crate) fn apart(output: &Path, read: &[&Path]) -> Result<(), Failure> {
    if read.iter().any(|path| is_same(path, output)) {
        let text = format!("`{}` is an input file and would be overwritten", output.display());
        return Err(Fault::new(text).hint("choose another name with `--output`").into());
    }
    Ok(())
}

fn refused(path: &Path, reason: &dyn Display) -> Fault {
    let fault = Fault::new(format!("cannot write to `{}`: {reason}", path.display()));
    fault.hint("nothing was rendered; choose another folder with --output")
}

/// The system's folder for temporary files. File names there contain the ID of this process.
pub(crate) struct Temporary;

impl Temporary {
    fn path(file: &str) -> PathBuf {
        let (stem, ending) = file.rsplit_once('.').unwrap_or((file, ""));
        std::env::temp_dir().join(format!("{stem}-{}.{ending}", std::process::id()))
    }
}

impl Sink for Temporary {
    fn file(&self, name: &str, content: Content<'_>) -> Result<(), WriteFault> {
        let path = Self::path(name);
        let file = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        files::DiskFolder(std::env::temp_dir()).file(&file, content)
    }
}

impl Folder for Temporary {
    fn prepare(&self, _: &str, _: &[&str]) -> Result<(), Fault> {
        Ok(())
    }

    fn has(&self, file: &str) -> bool {
        has(&Self::path(file))
    }

    fn read(&self, _: &str, _: u64) -> Option<Vec<u8>> {
        None
    }

    fn shown(&self, file: &str) -> String {
        Self::path(file).display().to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_pictures_are_files_and_others_folders() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("notes"), "").expect("written");
        std::fs::write(at("old.png"), "").expect("written");
        std::fs::create_dir(at("folder.png")).expect("made");
        for (name, is_file) in [
            ("new.png", true),
            ("old.png", true),
            ("a/b.TIF", true),
            ("new.txt", true),
            ("folder.png", false),
            ("out", false),
            ("v1.2", false),
        ] {
            let target = Target::of(&at(name)).expect(name);
            assert_eq!(target.folder != at(name), is_file, "{name}");
        }
        assert!(Target::of(&at("notes")).is_err());
        assert!(Target::of(Path::new("-")).is_err());
    }
}
