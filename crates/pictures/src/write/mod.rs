//! Files: each is written whole or not at all, and nothing in it changes from run to run.

mod dng;
mod exposure;
mod picture;
mod tiff;
mod tiled;

pub use dng::{RawLens, dng};
pub use exposure::{exr, half_exr, write_exr};
pub use picture::{png8, tiff16, write_png8, write_png16};
pub use tiled::tiled_exr;
