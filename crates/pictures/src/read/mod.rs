//! Reads picture files as linear light.

mod beginning;
mod block_check;
mod channels;
mod cmyk;
mod decode;
#[cfg(test)]
mod decode_tests;
mod encoding;
mod exif;
mod exr;
#[cfg(test)]
mod exr_tests;
mod header;
mod ink_profile;
mod jpeg;
mod library_formats;
mod linear_picture;
mod orientation;
mod picture_channels;
mod primaries;
mod profile;
mod radiance;
mod space;
mod tags;
mod tiff;
mod to_light;

pub use beginning::header;
pub use channels::planes;
pub use decode::{decode, depth, depth_overscan, is_exr};
pub use header::Header;
pub use library_formats::ENDINGS;
pub use linear_picture::{FileProblem, LinearPicture, ReadOptions};
pub use picture_channels::{ChannelData, PictureChannels};
