//! Built-in outputs: what is written of a picture.

mod dng;
mod exr;
mod png;
mod rays;
mod tiff;
