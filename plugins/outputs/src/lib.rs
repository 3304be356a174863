//! Built-in outputs: what is written of a picture.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod dng;
mod exr;
mod html;
mod jpeg;
mod npy;
mod png;
mod rays;
mod screen;
mod tiff;
