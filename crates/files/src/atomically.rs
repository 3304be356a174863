//! Files that appear under their name only when they are complete.

use crate::temporary::create_beside;
use crate::{WriteError, WriteFault};
use spectra_core::sink::{Content, Sink};
use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};

/// Whether writers lock the files that they write: only on Unix, where locks are advisory and do not block other programs.
pub(crate) const HOLDS: bool = cfg!(unix);

/// Lets `write` fill a temporary file in the folder of `path`, then renames it to `path`. If `write` or the system fails, an
/// older file of that name remains unchanged, and the temporary file is removed.
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
    // The lock keeps a cleanup after killed runs from removing this file. Without locks the cleanup goes by the age of the file.
    let _ = HOLDS.then(|| file.lock());
    let written = write(&mut file).and_then(|()| {
        // The content reaches the disk before the name does: if the machine stops in between, the old file remains.
        file.sync_all()?;
        drop(file);
        Ok(std::fs::rename(&temporary, path)?)
    });
    written.map_err(|fault| {
        // The reported fault matters more than a failure of the removal.
        let _ = std::fs::remove_file(&temporary);
        error(fault)
    })
}

/// A folder on disk that writes each file with [`write_atomically`].
#[derive(Clone, Debug)]
pub struct DiskFolder(pub PathBuf);

impl Sink for DiskFolder {
    fn file(&self, name: &str, content: Content<'_>) -> Result<(), WriteFault> {
        write_atomically(&self.0.join(name), |file| content(file)).map_err(|error| match error {
            WriteError::Io { cause, .. } => WriteFault::Io(cause),
            WriteError::Format { cause, .. } => WriteFault::Format(cause),
        })
    }
}

/// Copies a file with its permissions to `path`, as [`write_atomically`] does.
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
