//! `kind: npy`.
//!
//! Format: NumPy Enhancement Proposal 1, "A simple file format for NumPy arrays", version 1.0.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;
use spectra_core::sink::{Out, WriteFault};
use spectra_scene::{FileContent, Output, OutputEntry, Shot};

/// The linear exposure as a NumPy array: height x width x channels of 32-bit floats.
///
/// `numpy.load` reads it without a library for pictures, and so do most programs for data. The values are those of `exr`, in lux seconds or
/// in the unit of the channel, with the first row at the top. The names and units of the channels are in `exr` and in the report.
///
/// # Example
/// ```yaml
/// {kind: npy}
/// ```
///
/// # References
/// - NumPy Enhancement Proposal 1, A simple file format for NumPy arrays.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct NpyParams {}

spectra_core::register!(OutputEntry, "npy": NpyParams, build);

struct Npy;

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Output>, Faults> {
    params.parse::<NpyParams>().map(|_| Box::new(Npy) as Box<dyn Output>)
}

impl Output for Npy {
    fn kind(&self) -> &'static str {
        "npy"
    }

    fn ending(&self) -> [&'static str; 2] {
        ["", ".npy"]
    }

    fn content(&self) -> FileContent {
        FileContent::Numbers
    }

    fn write(&self, shot: &Shot<'_>, _: usize, out: &mut dyn Out) -> Result<(), WriteFault> {
        let size = shot.exposure.size;
        let planes: Vec<&[f32]> = shot.exposure.channels.iter().map(|channel| &channel.values[..]).collect();
        let shape = [size.height_px as usize, size.width_px as usize, planes.len()];
        Ok(write(out, shape, &planes, &shot.gains())?)
    }
}

/// First bytes of the file: the magic number, and version 1.0.
const MAGIC: [u8; 8] = *b"\x93NUMPY\x01\x00";

/// Writes planes of equal size, each multiplied by its gain, value by value.
fn write(out: &mut dyn Out, shape: [usize; 3], planes: &[&[f32]], gains: &[f64]) -> std::io::Result<()> {
    let [height, width, channels] = shape;
    let said = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({height}, {width}, {channels}), }}");
    // With its two length bytes and a line break, the header ends on a multiple of 64 bytes.
    let whole = (MAGIC.len() + 2 + said.len() + 1).next_multiple_of(64);
    let header = format!("{said:<0$}\n", whole - MAGIC.len() - 3);
    out.write_all(&MAGIC)?;
    out.write_all(&(header.len() as u16).to_le_bytes())?;
    out.write_all(header.as_bytes())?;
    let mut row = Vec::with_capacity(width * channels * 4);
    for at in (0..height * width).step_by(width.max(1)) {
        row.clear();
        for pixel in at..at + width {
            for (plane, gain) in planes.iter().zip(gains) {
                row.extend(((f64::from(plane[pixel]) * gain) as f32).to_le_bytes());
            }
        }
        out.write_all(&row)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    /// The bytes that `numpy.save` of NumPy 2.4 writes for this array of 2 x 3 x 2, header and values.
    #[test]
    fn the_bytes_are_those_of_numpy() {
        let (red, green) = ([1.0_f32, 2.0, 3.0, 4.0, 5.0, 6.0], [0.5_f32, 0.0, -1.0, 0.25, 8.0, 1e-3]);
        let mut out = Cursor::new(Vec::new());
        write(&mut out, [2, 3, 2], &[&red, &green], &[1.0, 2.0]).expect("memory");
        let bytes = out.into_inner();
        let said = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 2), }";
        assert_eq!(bytes[..10], *b"\x93NUMPY\x01\x00\x76\x00");
        assert_eq!(std::str::from_utf8(&bytes[10..128]).expect("ASCII"), format!("{said:<117}\n"));
        let values = bytes[128..].chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        let wanted = [1.0, 1.0, 2.0, 0.0, 3.0, -2.0, 4.0, 0.5, 5.0, 16.0, 6.0, 2e-3];
        assert_eq!(values.collect::<Vec<_>>(), wanted);
    }
}
