//! Where a library registers that reads or writes more picture formats than the program does by itself.
//!
//! A plain build has none. Code that needs one tells the user how to get it ([`WITHOUT`]).

use spectra_core::resources::Found;
use spectra_core::sink::Out;

/// What to tell the user where no library is linked.
pub const WITHOUT: &str = "this program was built without OpenImageIO: `cargo build --release --features oiio`";

/// The largest picture that a reader may unpack.
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
    /// Width, pixels, before `orientation` is applied.
    pub width_px: u32,
    /// Height, pixels.
    pub height_px: u32,
    /// Width of a pixel over its height.
    pub pixel_aspect: f64,
    /// Red, green and blue, row by row from the top as stored; integers are scaled so that their maximum is 1.
    pub rgb: Vec<[f32; 3]>,
    /// Opacity, 0 to 1; `None` where everything is opaque.
    pub alpha: Option<Vec<f32>>,
    /// Whether `rgb` is already multiplied by `alpha`, as code values.
    pub multiplied: bool,
    /// Whether the file holds integers, which are clipped at 1.
    pub integers: bool,
    /// The color encoding that the file states, as the library names it, such as `sRGB`; `None` if it states none.
    pub color_space: Option<String>,
    /// Orientation, 1 to 8 as the TIFF 6.0 tag `Orientation` defines it; 1 is upright.
    pub orientation: u8,
    /// The format as the library names it, such as `dpx`.
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
    /// Width and height of a tile, pixels, a multiple of 16.
    pub tile_px: u32,
    /// Name and values, row by row from the top, of each channel.
    pub channels: &'a [(&'a str, &'a [f32])],
    /// Name and text of each attribute of the header.
    pub attributes: &'a [(String, String)],
}

/// A library of picture formats.
pub trait PictureLibrary: Sync {
    /// Name and version, for display.
    fn name(&self) -> String;

    /// Reads the first picture of a file, given its extension (`dpx`, without the dot). It takes the memory of the pixels
    /// that it returns, and beside them no more than a part of them.
    ///
    /// # Errors
    /// What is wrong with the file, without a full stop: another format, broken, larger than `limits`.
    fn read(&self, ending: &str, file: &Found, limits: PictureLimits) -> Result<FilePicture, String>;

    /// What the header says of that picture: as [`PictureLibrary::read`], but without pixels and cover.
    ///
    /// # Errors
    /// As [`PictureLibrary::read`].
    fn header(&self, ending: &str, file: &Found, limits: PictureLimits) -> Result<FilePicture, String>;

    /// Writes a tiled OpenEXR file: 32-bit floats, lossless. The same picture gives the same bytes.
    ///
    /// # Errors
    /// The error of the system or the library.
    fn write_tiled_exr(&self, to: &mut dyn Out, picture: &TiledExr<'_>) -> Result<(), String>;
}

/// A library as it is registered by `inventory::submit!`.
pub struct PictureLibraryEntry(pub &'static dyn PictureLibrary);

inventory::collect!(PictureLibraryEntry);

/// The library that this program is linked with, if any; the first by name if there are several.
#[must_use]
pub fn library() -> Option<&'static dyn PictureLibrary> {
    inventory::iter::<PictureLibraryEntry>.into_iter().map(|entry| entry.0).min_by_key(|library| library.name())
}
