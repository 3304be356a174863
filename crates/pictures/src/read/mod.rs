//! Reads picture files as linear light.

mod beginning;
mod channels;
mod cmyk;
mod decode;
mod encoding;
mod exif;
mod exr;
#[cfg(test)]
mod exr_tests;
mod foreign;
mod header;
mod inks;
mod jpeg;
mod linear;
mod packed;
mod planes;
mod primaries;
mod profile;
mod radiance;
mod space;
mod tags;
mod tiff;
mod turn;

pub use beginning::header;
pub use channels::planes;
pub use decode::{decode, depth, depth_overscan, is_exr};
pub use foreign::ENDINGS;
pub use header::Header;
pub use linear::{Choice, Linear, Trouble};
pub use planes::{Plane, Planes};
