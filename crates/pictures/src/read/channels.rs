//! Reads all channels of a picture file.

use super::decode::{self, Kind};
use super::exr;
use super::linear_picture::{FileProblem, ReadOptions};
use super::picture_channels::{ChannelData, PictureChannels};
use spectra_core::resources::{FoundFile, ResourceError};

/// Reads all channels of an OpenEXR file with the values that it stores. A file of any other format that
/// [`decode()`](super::decode()) supports is read as linear light in `R`, `G` and `B`.
///
/// # Errors
/// What is wrong with the file.
pub fn planes(found: &FoundFile, choice: ReadOptions<'_>) -> Result<PictureChannels, FileProblem> {
    let io = |error: ResourceError| FileProblem::file(error.to_string());
    let kind = decode::kind(&found.read(64).map_err(io)?, choice)?;
    if kind == Kind::Exr {
        return exr::planes(found.open().map_err(io)?, found.size_bytes().map_err(io)?);
    }
    let format = match kind {
        Kind::Native(image::ImageFormat::Png) => "PNG",
        Kind::Native(image::ImageFormat::Jpeg) => "JPEG",
        Kind::Native(image::ImageFormat::Tiff) => "TIFF",
        Kind::Native(image::ImageFormat::Hdr) => "Radiance HDR",
        _ => "by OpenImageIO",
    };
    let mut doubts = super::header(found, choice)?.warnings;
    let linear = decode::decode(found, choice)?;
    doubts.extend(linear.warnings.iter().cloned());
    let channel = |(at, name): (usize, &str)| ChannelData {
        name: name.to_owned(),
        unit: String::new(),
        values: linear.rgb.iter().map(|rgb| rgb[at]).collect(),
    };
    Ok(PictureChannels {
        format,
        width: linear.width,
        height: linear.height,
        pixel_aspect: linear.pixel_aspect,
        channels: ["R", "G", "B"].into_iter().enumerate().map(channel).collect(),
        chromaticities: None,
        attributes: Vec::new(),
        clipped_at: linear.clipped_at,
        warnings: doubts,
    })
}
