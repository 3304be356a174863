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

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod atomically;
mod folder;
pub mod leftover;
mod temporary;

pub use atomically::{Folder, copy_atomically, write_atomically};
pub use folder::write_folder;
pub use spectra_core::sink::WriteFault;

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
