//! A file appears under its name only when it is complete.

use crate::temporary::create_beside;
use crate::{WriteError, WriteFault};
use spectra_core::sink::{Content, Sink};
use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};

/// Whether writers lock what they write: where a lock is only a word among those who ask for it.
pub(crate) const HOLDS: bool = cfg!(unix);

/// Lets `write` fill a temporary file in the folder of `path`, then gives it that name. Where `write` or
/// the system fails, an older file of that name stays as it was and the temporary one is removed.
///
/// # Errors
/// [`WriteError`], which names `path`.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<(), WriteFault>,
) -> Result<(), WriteError> {
    let error = |fault: WriteFault| match fault {
        WriteFault::Io(cause) => WriteError::Io { path: path.into(), cause },
        WriteFault::Format(cause) => WriteError::Format { path: path.into(), cause },
    };
    let create = |name: &Path| OpenOptions::new().read(true).write(true).create_new(true).open(name);
    let (mut file, temporary) = create_beside(path, create).map_err(|e| error(e.into()))?;
    // Who sweeps up after runs that were killed leaves alone what is held; where there are no locks, the age of a file has to do.
    let _ = HOLDS.then(|| file.lock());
    let written = write(&mut file).and_then(|()| {
        // On the disk before the name is: a machine that stops between leaves the old file.
        file.sync_all()?;
        drop(file);
        Ok(std::fs::rename(&temporary, path)?)
    });
    written.map_err(|fault| {
        // What removal says adds nothing to the fault that is reported.
        let _ = std::fs::remove_file(&temporary);
        error(fault)
    })
}

/// A folder on disk that takes files, each as [`write_atomically`] writes it.
#[derive(Clone, Debug)]
pub struct Folder(pub PathBuf);

impl Sink for Folder {
    fn file(&self, name: &str, content: Content<'_>) -> Result<(), WriteFault> {
        write_atomically(&self.0.join(name), |file| content(file)).map_err(|error| match error {
            WriteError::Io { cause, .. } => WriteFault::Io(cause),
            WriteError::Format { cause, .. } => WriteFault::Format(cause),
        })
    }
}

/// Copies a file with its rights to `path`, as [`write_atomically`] writes one.
///
/// # Errors
/// [`WriteError`], which names `path`.
pub fn copy_atomically(from: &Path, path: &Path) -> Result<(), WriteError> {
    write_atomically(path, |file| {
        std::io::copy(&mut File::open(from)?, file)?;
        Ok(file.set_permissions(std::fs::metadata(from)?.permissions())?)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).expect("a folder");
        entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.txt");
        write_atomically(&path, |f| Ok(f.write_all(b"old")?)).expect("written");
        let fault = write_atomically(&path, |f| {
            f.write_all(b"new")?;
            Err(WriteFault::Format("too odd".into()))
        });
        assert!(fault.unwrap_err().to_string().ends_with("a.txt: cannot be written: too odd"));
        assert_eq!(std::fs::read(&path).expect("still there"), b"old");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn errors_name_the_path() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("missing/a.txt");
        let text = write_atomically(&path, |_| Ok(())).unwrap_err().to_string();
        assert!(text.contains("missing/a.txt"), "{text}");
    }

    #[test]
    #[cfg(unix)]
    fn a_copy_has_the_rights_of_the_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a folder");
        let [from, to] = ["a", "b"].map(|name| folder.path().join(name));
        std::fs::write(&from, b"a program").expect("written");
        std::fs::set_permissions(&from, std::fs::Permissions::from_mode(0o750)).expect("set");
        copy_atomically(&from, &to).expect("copied");
        assert_eq!(std::fs::read(&to).expect("there"), b"a program");
        assert_eq!(std::fs::metadata(&to).expect("there").permissions().mode() & 0o777, 0o750);
        assert!(copy_atomically(&folder.path().join("c"), &to).is_err());
        assert_eq!(std::fs::read(&to).expect("still there"), b"a program");
    }
}
