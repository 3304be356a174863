//! A file appears under its name only when it is complete.

use super::{WriteError, WriteFault};
use spectra_core::sink::{Content, Sink};
use std::fs::{File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

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
    let (mut file, temporary) = create_beside(path).map_err(|e| error(e.into()))?;
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

/// A folder on disk that takes files, each written to a temporary name and renamed.
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

fn create_beside(path: &Path) -> io::Result<(File, PathBuf)> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let Some(name) = path.file_name() else {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "a file name is missing"));
    };
    loop {
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{}-{}.tmp", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed)));
        let temporary = path.with_file_name(hidden);
        match OpenOptions::new().read(true).write(true).create_new(true).open(&temporary) {
            Ok(file) => return Ok((file, temporary)),
            // Left by a process of the same number that was killed: take the next name.
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
            Err(e) => return Err(e),
        }
    }
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
}
