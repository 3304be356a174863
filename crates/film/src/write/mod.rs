//! Files: each is written whole or not at all, and nothing in it changes from run to run.

mod atomically;
mod dng;
mod exposure;
pub mod leftover;
mod picture;
mod tiff;
mod tiled;

pub use atomically::{Folder, write_atomically};
pub use dng::{RawLens, dng};
pub use exposure::{exr, half_exr, write_exr};
pub use picture::{png8, tiff16, write_png8, write_png16};
pub use spectra_core::sink::WriteFault;
pub use tiled::tiled_exr;

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
