//! Writing to disk: a file or a folder appears under its name complete, or not at all.
//!
//! - [`write_atomically`]: a file that is filled by a function;
//! - [`copy_atomically`]: a copy of a file, with its permissions;
//! - [`write_folder`]: a new folder with files in it.
//!
//! This is the only crate of the engine that writes to a disk. A file in progress has a hidden temporary name in the same folder,
//! `.NAME.PROCESS-NUMBER.tmp`, so that the last step is a rename. After a failure it is removed.
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

pub use atomically::{DiskFolder, copy_atomically, write_atomically};
pub use folder::write_folder;
pub use spectra_core::sink::WriteFault;

use std::path::PathBuf;

/// Error of a file that could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The system refused: no such folder, no permission, disk full.
    #[error("{}: cannot be written: {cause}", path.display())]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// Error of the system.
        cause: std::io::Error,
    },
    /// The format cannot hold the content.
    #[error("{}: cannot be written: {cause}", path.display())]
    Format {
        /// Path of the file.
        path: PathBuf,
        /// Reason, as text.
        cause: String,
    },
}
