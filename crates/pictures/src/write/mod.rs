//! Writes picture files. Each is written completely or not at all, and the bytes do not change from run to run.

mod dng;
mod exposure;
mod icc;
mod linear;
mod picture;
mod resample;
mod space;
mod srgb8_table;
mod tiff;
mod tiled;

pub use dng::{RawLens, dng};
pub use exposure::{exr, half_exr, write_exr};
pub use icc::display_profile;
pub use linear::{LinearSpace, picture_exr};
pub use picture::{jpeg, png8, png16, tiff16, write_png8, write_png16};
pub use resample::squared;
pub use space::PictureSpace;
#[cfg(test)]
pub(crate) use space::chunk;
pub use tiled::tiled_exr;
