//! Registry for a library that reads or writes more picture formats than this crate does.
//!
//! A plain build has no such library. Code that needs one tells the user how to get it ([`WITHOUT`]).

use spectra_core::params::Fault;
use spectra_core::resources::FoundFile;
use spectra_core::sink::{Out, WriteFault};

/// Message for the user if no picture library is linked.
pub const WITHOUT: &str = "this program was built without OpenImageIO: `cargo build --release --features oiio`";

/// Size limits of a picture that a reader may unpack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureLimits {
    /// Largest side, pixels.
    pub side_px: u32,
    /// Largest number of pixels.
    pub pixels: u64,
}

/// A picture as stored in its file: code values, not yet linear light.
#[derive(Clone, Debug, PartialEq)]
pub struct FilePicture {
    /// Width (pixels) before `orientation` is applied.
    pub width_px: u32,
    /// Height (pixels) before `orientation` is applied.
    pub height_px: u32,
    /// Width of a pixel over its height.
    pub pixel_aspect: f64,
    /// Red, green and blue, row by row from the top as stored; integers are scaled so that their maximum is 1.
    pub rgb: Vec<[f32; 3]>,
    /// Opacity, 0 to 1; `None` if everything is opaque.
    pub alpha: Option<Vec<f32>>,
    /// Whether `rgb` is already multiplied by `alpha`, as code values.
    pub multiplied: bool,
    /// Whether the file holds integers, which clip at 1.
    pub integers: bool,
    /// Color encoding that the file states, as the library names it, for example `sRGB`; `None` if it states none.
    pub color_space: Option<String>,
    /// Orientation, 1 to 8 as the TIFF 6.0 tag `Orientation` defines it; 1 is upright.
    pub orientation: u8,
    /// Name of the format in the library, for example `dpx`.
    pub format: String,
}

/// Linear channels to write as a tiled OpenEXR file.
#[derive(Clone, Copy, Debug)]
pub struct TiledExr<'a> {
    /// Width, pixels.
    pub width_px: u32,
    /// Height, pixels.
    pub height_px: u32,
    /// Width of a pixel over its height.
    pub pixel_aspect: f32,
    /// Width and height of a tile, in pixels; a multiple of 16.
    pub tile_px: u32,
    /// Name and values of each channel. Values go row by row from the top.
    pub channels: &'a [(&'a str, &'a [f32])],
    /// Name and text of each header attribute.
    pub attributes: &'a [(String, String)],
}

/// A library of picture formats, for example OpenImageIO.
pub trait PictureLibrary: Sync {
    /// Returns name and version of the library, for display.
    fn name(&self) -> String;

    /// Reads the first picture of `file`. `ending` is the extension of its name without the dot, such as `dpx`. Besides the
    /// pixels that it returns, the implementation needs only a fraction of their memory.
    ///
    /// # Errors
    /// What is wrong with the file, without a full stop: another format, broken, or larger than `limits`.
    fn read(&self, ending: &str, file: &FoundFile, limits: PictureLimits) -> Result<FilePicture, Fault>;

    /// Reads the header of the first picture. The result is that of [`PictureLibrary::read`], but `rgb` is empty and `alpha` is
    /// `None`.
    ///
    /// # Errors
    /// The errors of [`PictureLibrary::read`].
    fn header(&self, ending: &str, file: &FoundFile, limits: PictureLimits) -> Result<FilePicture, Fault>;

    /// Writes a tiled OpenEXR file: 32-bit floats, lossless. The same picture gives the same bytes.
    ///
    /// # Errors
    /// The error of the system or the library.
    fn write_tiled_exr(&self, to: &mut dyn Out, picture: &TiledExr<'_>) -> Result<(), WriteFault>;
}

/// Registration of a picture library with `inventory::submit!`.
pub struct PictureLibraryEntry(pub &'static dyn PictureLibrary);

inventory::collect!(PictureLibraryEntry);

/// Returns the picture library that this program is linked with, if any. If there are several, the first by name.
#[must_use]
pub fn library() -> Option<&'static dyn PictureLibrary> {
    inventory::iter::<PictureLibraryEntry>.into_iter().map(|entry| entry.0).min_by_key(|library| library.name())
}
