//! Writes the linear exposure as tiled OpenEXR.

use super::exposure::{all_attributes, pixel_aspect, times};
use crate::library::{self, TiledExr};
use spectra_core::frame::ExposureFrame;
use spectra_core::sink::Out;
use spectra_files::WriteFault;

/// Side of a tile, in pixels: the value that texture tools use.
const TILE_PX: u32 = 64;

/// Writes the frame as [`super::exr()`] does, but in tiles of 64 x 64 pixels, with the linked picture library. The same frame and
/// attributes give the same bytes.
///
/// # Errors
/// [`WriteFault`]: the system refuses, there is no such library, the frame has no channel or too few values, or an attribute has no name or
/// is given twice.
pub fn tiled_exr(
    out: &mut dyn Out,
    frame: &ExposureFrame,
    gains: &[f64],
    squeeze: f64,
    attributes: &[(String, String)],
) -> Result<(), WriteFault> {
    let Some(own) = library::library() else {
        return Err(WriteFault::Format(library::WITHOUT.to_owned()));
    };
    let attributes: Vec<(String, String)> = all_attributes(frame, attributes).collect();
    for (i, (name, _)) in attributes.iter().enumerate() {
        if name.is_empty() || attributes[..i].iter().any(|(other, _)| other == name) {
            return Err(WriteFault::Format(format!("an attribute has no name or is given twice: `{name}`")));
        }
    }
    let gain = |at: usize| gains.get(at).copied().unwrap_or(1.0);
    let values: Vec<Vec<f32>> = frame.channels.iter().enumerate().map(|(at, c)| times(&c.values, gain(at))).collect();
    let channels: Vec<(&str, &[f32])> =
        frame.channels.iter().zip(&values).map(|(c, values)| (c.name.as_str(), values.as_slice())).collect();
    let picture = TiledExr {
        width_px: frame.size.width_px,
        height_px: frame.size.height_px,
        pixel_aspect: (f64::from(pixel_aspect(frame)) * squeeze) as f32,
        tile_px: TILE_PX,
        channels: &channels,
        attributes: &attributes,
    };
    own.write_tiled_exr(out, &picture)
}
