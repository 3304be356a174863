//! Picture files beyond those that the program reads and writes by itself: a library for them registers here.
//!
//! Nothing is registered in a plain build. What asks for a library that is not there says how to get it
//! ([`WITHOUT`]).

use std::fs::File;

/// How to get the formats of a library, where none is linked.
pub const WITHOUT: &str = "this program was built without OpenImageIO: `cargo build --release --features oiio`";

/// Largest picture that a reader may unpack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureLimits {
    /// Largest side, pixels.
    pub side_px: u32,
    /// Largest number of pixels in all.
    pub pixels: u64,
}

/// A picture as its file has it: code values, not yet light.
#[derive(Clone, Debug, PartialEq)]
pub struct FilePicture {
    /// Width, pixels, before the picture is turned as `orientation` says.
    pub width_px: u32,
    /// Height, pixels.
    pub height_px: u32,
    /// Width over height of a pixel.
    pub pixel_aspect: f64,
    /// Red, green and blue, row by row from the top as stored; integers are scaled so that the largest is 1.
    pub rgb: Vec<[f32; 3]>,
    /// Cover, 0 to 1; `None` where all of it is opaque.
    pub alpha: Option<Vec<f32>>,
    /// Whether `rgb` is already multiplied by `alpha`, as code values.
    pub multiplied: bool,
    /// Whether the file holds integers, which are clipped at 1.
    pub integers: bool,
    /// What the file says about its encoding, in the words of the library, such as `sRGB`; `None` where it is silent.
    pub color_space: Option<String>,
    /// How it must be turned to be upright, 1 to 8, as the tag `Orientation` of TIFF 6.0 has it; 1 is upright.
    pub orientation: u8,
    /// The format, in the words of the library, such as `dpx`.
    pub format: String,
}

/// Linear channels that are to be written as a tiled OpenEXR file.
#[derive(Clone, Copy, Debug)]
pub struct TiledExr<'a> {
    /// Width, pixels.
    pub width_px: u32,
    /// Height, pixels.
    pub height_px: u32,
    /// Width over height of a pixel.
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
    /// Name and version, for people.
    fn name(&self) -> String;

    /// Reads the first picture of a file by its ending (`dpx`, without the dot) and content.
    ///
    /// # Errors
    /// What is wrong with the file, in a sentence without a full stop: not of that format, broken, larger than `limits`.
    fn read(&self, ending: &str, bytes: &[u8], limits: PictureLimits) -> Result<FilePicture, String>;

    /// Writes a tiled OpenEXR file: 32-bit floats, lossless. The same picture gives the same bytes.
    ///
    /// # Errors
    /// What the system or the library says.
    fn write_tiled_exr(&self, to: &mut File, picture: &TiledExr<'_>) -> Result<(), String>;
}

/// A library on offer, to be handed to `inventory::submit!`.
pub struct PictureLibraryEntry(pub &'static dyn PictureLibrary);

inventory::collect!(PictureLibraryEntry);

/// The library that this program is linked with, if any; of several the first by name.
#[must_use]
pub fn library() -> Option<&'static dyn PictureLibrary> {
    inventory::iter::<PictureLibraryEntry>.into_iter().map(|entry| entry.0).min_by_key(|library| library.name())
}
