//! Registers OpenImageIO as a picture library.

use crate::bridge::ffi;
use crate::{reading, writing};
use spectra_core::params::Fault;
use spectra_core::resources::FoundFile;
use spectra_core::sink::{Out, WriteFault};
use spectra_pictures::library::{FilePicture, PictureLibrary, PictureLibraryEntry, PictureLimits, TiledExr};

/// The picture library OpenImageIO (Larry Gritz and others, <https://openimageio.org>).
#[derive(Clone, Copy, Debug)]
pub struct OpenImageIo;

impl OpenImageIo {
    /// Returns the extensions of the files that OpenImageIO reads, without the dot.
    #[must_use]
    pub fn endings() -> Vec<String> {
        reading::endings()
    }
}

impl PictureLibrary for OpenImageIo {
    fn name(&self) -> String {
        format!("OpenImageIO {}", ffi::version())
    }

    fn read(&self, ending: &str, file: &FoundFile, limits: PictureLimits) -> Result<FilePicture, Fault> {
        reading::read(ending, file, limits, true).map_err(Fault::new)
    }

    fn header(&self, ending: &str, file: &FoundFile, limits: PictureLimits) -> Result<FilePicture, Fault> {
        reading::read(ending, file, limits, false).map_err(Fault::new)
    }

    fn write_tiled_exr(&self, to: &mut dyn Out, picture: &TiledExr<'_>) -> Result<(), WriteFault> {
        writing::tiled_exr(to, picture)
    }
}

inventory::submit! { PictureLibraryEntry(&OpenImageIo) }
