//! Bytes to pictures and back.
//!
//! - [`read`]: picture files to linear light: OpenEXR, PNG, JPEG, TIFF, WebP, BMP, Radiance HDR, and others by a library;
//! - [`mod@write`]: exposures, pictures for a screen and raw frames to files: OpenEXR, PNG, JPEG, TIFF, DNG;
//! - [`library`]: where a library registers that knows more formats.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod library;
pub mod read;
pub mod write;
