//! Picture files by OpenImageIO: DPX, JPEG 2000, WebP, PSD, textures and more in, tiled OpenEXR out.
//!
//! Empty without the feature `oiio`, so that a plain build needs neither a C++ compiler nor a C++ library. With it the
//! crate registers a `spectra_pictures::library::PictureLibrary`, and the picture sources and the `exr` output find
//! it there. The library is called through a bridge of this crate's own (`bridge.h`), for OpenImageIO 2.4 and later.
//!
//! What its readers do with a hostile file is the library's own doing: its exceptions become errors, sizes are
//! checked before pictures are unpacked, but a fault in one of its readers can end the program.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg(feature = "oiio")]

mod bridge;
mod library;
mod reading;
mod stated;
mod writing;

pub use library::OpenImageIo;
pub use writing::{Samples, Written, make_texture, write};
