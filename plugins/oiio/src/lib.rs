//! Picture files with OpenImageIO: reads DPX, JPEG 2000, WebP, PSD, textures and more, and writes tiled OpenEXR.
//!
//! The crate is empty without the feature `oiio`, so that a plain build needs neither a C++ compiler nor a C++ library.
//! With the feature it registers a `spectra_pictures::library::PictureLibrary`, which the picture sources and the `exr` output use.
//! A bridge of this crate (`bridge.h`) calls the library, OpenImageIO 2.4 or later.
//!
//! Hostile files: exceptions of the library become errors, and sizes are checked before pictures are unpacked. A bug in one of the
//! library's readers can still crash the program.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg(feature = "oiio")]

mod bridge;
mod header_size;
mod library;
mod reading;
mod writing;

pub use library::OpenImageIo;
pub use writing::{Samples, Written, make_texture, write};
