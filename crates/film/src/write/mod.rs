//! Files: each is written whole or not at all, and nothing in it changes from run to run.

mod atomically;
mod dng;
mod exposure;
mod picture;
mod tiff;
mod tiled;

pub use atomically::write_atomically;
pub use dng::{RawLens, write_dng};
pub use exposure::{write_exr, write_exr_times, write_half_exr};
pub use picture::{write_png8, write_png8_of_pixels, write_png16, write_tiff16};
pub use tiled::{write_tiled_exr, write_tiled_exr_times};

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
