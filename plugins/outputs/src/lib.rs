//! Built-in outputs: the files that are written for a picture.

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
