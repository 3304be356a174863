//! Reads and writes picture files.
//!
//! - [`read`]: reads picture files as linear light: OpenEXR, PNG, JPEG, TIFF, WebP, BMP, Radiance HDR, and others with a linked library;
//! - [`mod@write`]: writes exposures, pictures for a screen and raw frames: OpenEXR, PNG, JPEG, TIFF, DNG;
//! - [`library`]: the registry for a library that supports more formats.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod library;
pub mod read;
pub mod write;
