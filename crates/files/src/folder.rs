//! Folders that appear under their name only when they are complete.

use crate::WriteError;
use crate::temporary::create_beside;
use std::io;
use std::path::Path;

/// Creates the folder `path` and fills it with `files`: pairs of a name, with `/` between folders, and a text. The parent of
/// `path` must exist, and `path` itself must not.
///
/// # Errors
/// [`WriteError::Io`], which names `path`; nothing of the folder remains then.
pub fn write_folder(path: &Path, files: &[(&str, String)]) -> Result<(), WriteError> {
    let error = |cause| WriteError::Io { path: path.into(), cause };
    let create = |name: &Path| std::fs::create_dir(name);
    let ((), temporary) = create_beside(path, create).map_err(error)?;
    let written = fill(&temporary, files).and_then(|()| {
        // A rename would replace an empty folder that another process has made meanwhile.
        if path.exists() { Err(io::ErrorKind::AlreadyExists.into()) } else { std::fs::rename(&temporary, path) }
    });
    written.map_err(|cause| {
        // The reported fault matters more than a failure of the removal.
        let _ = std::fs::remove_dir_all(&temporary);
        error(cause)
    })
}

fn fill(folder: &Path, files: &[(&str, String)]) -> io::Result<()> {
    for (name, text) in files {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap_or(folder))?;
        std::fs::write(path, text)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_there_with_all_of_its_files() {
        let parent = tempfile::tempdir().expect("a folder");
        let path = parent.path().join("x");
        write_folder(&path, &[("a/b", "1".into()), ("c", "2".into())]).expect("written");
        assert_eq!(std::fs::read(path.join("a/b")).expect("there"), b"1");
        assert_eq!(std::fs::read(path.join("c")).expect("there"), b"2");
        assert!(write_folder(&path, &[]).is_err(), "it is there already");
        assert_eq!(std::fs::read_dir(parent.path()).expect("a folder").count(), 1);
    }

    #[test]
    fn nothing_is_left_of_what_fails() {
        let parent = tempfile::tempdir().expect("a folder");
        let files = [("a/b", "text".into()), ("a", "a folder has that name".into())];
        let error = write_folder(&parent.path().join("x"), &files).expect_err("refused");
        assert!(error.to_string().contains("x: cannot be written: "), "{error}");
        assert_eq!(std::fs::read_dir(parent.path()).expect("a folder").count(), 0);
    }
}
