//! Bytes to disk: a file or a folder appears under its name whole, or not at all.
//!
//! - [`write_atomically`]: a file that is filled by a function;
//! - [`copy_atomically`]: a copy of a file, with its rights;
//! - [`write_folder`]: a new folder with files in it.
//!
//! The only room of the engine that writes to a disk. What is under way has a hidden temporary name in the same folder,
//! `.NAME.PROCESS-NUMBER.tmp`, so that the last step is a renaming; a failure removes it.
//!
//! ```
//! # fn main() -> Result<(), spectra_files::WriteError> {
//! # let folder = tempfile::tempdir().expect("a folder");
//! # let path = folder.path().join("a.txt");
//! use std::io::Write;
//! spectra_files::write_atomically(&path, |file| Ok(file.write_all(b"all of it")?))?;
//! # Ok(())
//! # }
//! ```

mod atomically;
mod folder;
mod temporary;

pub use atomically::{copy_atomically, write_atomically};
pub use folder::write_folder;

use std::path::PathBuf;

/// A file that could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The system refused: no such folder, no right, disk full.
    #[error("{}: cannot be written: {cause}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's word.
        cause: std::io::Error,
    },
    /// The format cannot hold the content.
    #[error("{}: cannot be written: {cause}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: String,
    },
}

/// What went wrong while the content was written; [`write_atomically`] adds the path.
#[derive(Debug)]
pub enum WriteFault {
    /// The system's word.
    Io(std::io::Error),
    /// Why the format cannot hold the content.
    Format(String),
}

impl From<std::io::Error> for WriteFault {
    fn from(cause: std::io::Error) -> Self {
        Self::Io(cause)
    }
}
