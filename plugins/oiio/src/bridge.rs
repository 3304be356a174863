//! The border to C++: what crosses it, in both directions. `bridge.cc` is the other side.
// The only unsafe code of this crate is what `cxx` generates from the declarations below, whose types it checks on both
// sides; each C++ function keeps what it opens on its own stack, and no pointer outlives its call.
#![allow(unsafe_code)]

// A circle with `reading.rs`: C++ hands what it reads to the receiver that called it.
use crate::reading::Receiver;
// A circle with `writing.rs`: C++ takes pixels from what called it, and hands it the bytes.
use crate::writing::{Pixels, Sink};

#[cxx::bridge(namespace = "spectra")]
pub(crate) mod ffi {
    /// What the header of a file says of its first picture.
    #[derive(Clone)]
    struct Header {
        /// Where the stored pixels lie, and how many they are: x, y, width, height.
        data: [i64; 4],
        /// The window that is shown: x, y, width, height.
        display: [i64; 4],
        /// 1, but for volumes.
        slices: i64,
        /// Several samples a pixel.
        deep: bool,
        channels: Vec<String>,
        /// Number of the channel of cover; -1 without.
        alpha: i32,
        /// Integers, in place of floating point.
        integers: bool,
        /// `oiio:ColorSpace`, or else `dpx:Transfer`; empty if absent.
        color_space: String,
        /// `Orientation`.
        orientation: i32,
        /// `PixelAspectRatio`.
        pixel_aspect: f32,
        /// Whether the colors come without cover multiplied in.
        straight: bool,
    }

    /// Channels to be read: from, and up to without; none where the header is all that is wanted.
    struct Wanted {
        first: i32,
        end: i32,
    }

    /// A picture to be written.
    struct Plan {
        /// Name of the format.
        format: String,
        /// A name for messages, whose ending may tell variants of the format.
        path: String,
        width: i32,
        height: i32,
        channels: Vec<String>,
        /// `uint8`, `uint16`, `half` or `float`.
        samples: String,
        /// Side of a tile; 0 for rows.
        tile: i32,
        /// 0 if absent.
        pixel_aspect: f32,
        names: Vec<String>,
        texts: Vec<String>,
        integer_names: Vec<String>,
        integers: Vec<i32>,
    }

    extern "Rust" {
        type Receiver;
        fn begin(self: &mut Receiver, header: &Header) -> Result<Wanted>;
        fn rows(self: &mut Receiver, first: i64, values: &[f32]);

        type Pixels<'a>;
        fn fill(self: &Pixels<'_>, first: i32, to: &mut [f32]);

        type Sink<'a>;
        fn write_at(self: &mut Sink<'_>, bytes: &[u8], offset: i64) -> bool;
        fn size(self: &Sink<'_>) -> i64;
    }

    unsafe extern "C++" {
        include!("spectra-plugin-oiio/src/bridge.h");

        /// The library's version.
        fn version() -> String;
        /// The formats that are read, each with its endings: `dpx:dpx;targa:tga,tpic`.
        fn endings() -> Result<String>;
        /// Whether files of the format can be read from memory.
        fn reads_memory(format: &str) -> Result<bool>;
        /// Reads the first picture from the file at `path`, or else from `bytes`; the path's ending may tell variants.
        fn read(format: &str, path: &str, from_memory: bool, bytes: &[u8], receiver: &mut Receiver) -> Result<()>;
        /// Writes a picture.
        fn write(plan: &Plan, pixels: &Pixels<'_>, sink: &mut Sink<'_>) -> Result<()>;
        /// Writes a texture: tiled, with all sizes down to one pixel.
        fn make_texture(plan: &Plan, pixels: &Pixels<'_>, path: &str) -> Result<()>;
    }
}
