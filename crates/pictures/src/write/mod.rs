//! Files: each is written whole or not at all, and nothing in it changes from run to run.

mod dng;
mod exposure;
mod picture;
mod tiff;
mod tiled;

pub use dng::{RawLens, write_dng};
pub use exposure::{write_exr, write_exr_times, write_half_exr};
pub use picture::{write_png8, write_png8_of_pixels, write_png16, write_tiff16};
pub use tiled::{write_tiled_exr, write_tiled_exr_times};
