//! Raw frames as DNG: what raw converters open.

use super::{WriteError, WriteFault, write_atomically};
use spectra_core::frame::RawFrame;
use std::io::{BufWriter, Write};
use std::path::Path;

/// A field of the directory: tag, type, count, and its value or the bytes that stand behind the directory.
struct Field {
    tag: u16,
    kind: u16,
    count: u32,
    bytes: Vec<u8>,
}

// Types of TIFF 6.0.
const BYTE: u16 = 1;
const ASCII: u16 = 2;
const SHORT: u16 = 3;
const LONG: u16 = 4;
const RATIONAL: u16 = 5;
const SRATIONAL: u16 = 10;

fn bytes(tag: u16, values: &[u8]) -> Field {
    Field { tag, kind: BYTE, count: values.len() as u32, bytes: values.to_vec() }
}

fn text(tag: u16, value: &str) -> Field {
    let mut bytes: Vec<u8> = value.bytes().filter(|b| *b != 0).collect();
    bytes.push(0);
    Field { tag, kind: ASCII, count: bytes.len() as u32, bytes }
}

fn shorts(tag: u16, values: &[u16]) -> Field {
    let bytes = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    Field { tag, kind: SHORT, count: values.len() as u32, bytes }
}

fn long(tag: u16, value: u32) -> Field {
    Field { tag, kind: LONG, count: 1, bytes: value.to_le_bytes().to_vec() }
}

/// Numbers of 0 to 4000, to a millionth.
fn rationals(tag: u16, values: &[f64]) -> Field {
    let one = |v: &f64| [(v * 1e6).round() as u32, 1_000_000].map(u32::to_le_bytes).concat();
    Field { tag, kind: RATIONAL, count: values.len() as u32, bytes: values.iter().flat_map(one).collect() }
}

/// Numbers of -2000 to 2000, to a millionth.
fn signed_rationals(tag: u16, values: &[f64]) -> Field {
    let one = |v: &f64| [(v * 1e6).round() as i32, 1_000_000].map(i32::to_le_bytes).concat();
    Field { tag, kind: SRATIONAL, count: values.len() as u32, bytes: values.iter().flat_map(one).collect() }
}

/// Exposure time as photographers write it: a whole fraction where it is one.
fn exposure(tag: u16, time_s: f64) -> Field {
    let inverse = 1.0 / time_s;
    let whole = (inverse.round() - inverse).abs() < 1e-6 * inverse && (1.0..1e9).contains(&inverse);
    let pair = if whole { [1, inverse.round() as u32] } else { [(time_s * 1e6).round() as u32, 1_000_000] };
    Field { tag, kind: RATIONAL, count: 1, bytes: pair.map(u32::to_le_bytes).concat() }
}

/// Writes the frame as DNG: one uncompressed strip of 16 bits a pixel, little-endian, with the filters' pattern, black and
/// white level, the color matrix and the neutral color (Adobe Systems, Digital Negative Specification 1.4.0.0). The same
/// frame gives the same bytes.
///
/// # Errors
/// [`WriteError`]: the system refuses, or the number of values is not that of the size.
pub fn write_dng(path: &Path, frame: &RawFrame) -> Result<(), WriteError> {
    write_atomically(path, |file| {
        let mut to = BufWriter::new(file);
        to.write_all(&head(frame)?)?;
        for row in frame.values.chunks(frame.width_px.max(1) as usize) {
            let bytes: Vec<u8> = row.iter().flat_map(|v| v.to_le_bytes()).collect();
            to.write_all(&bytes)?;
        }
        Ok(to.flush()?)
    })
}

/// All that stands before the pixels.
fn head(frame: &RawFrame) -> Result<Vec<u8>, WriteFault> {
    let (width, height, found) = (frame.width_px, frame.height_px, frame.values.len());
    let size = found as u64 * 2;
    if found == 0 || found as u64 != u64::from(width) * u64::from(height) || size > u64::from(u32::MAX) - 65_536 {
        return Err(WriteFault::Format(format!("{found} values for a raw frame of {width} x {height}")));
    }
    const COLOR_FILTER_ARRAY: u16 = 32_803;
    const LINEAR_RAW: u16 = 34_892;
    let interpretation = if frame.pattern.is_some() { COLOR_FILTER_ARRAY } else { LINEAR_RAW };
    const STRIP_OFFSETS: u16 = 273;
    let mut fields = vec![
        long(254, 0), // NewSubfileType: the picture in full
        long(256, width),
        long(257, height),
        shorts(258, &[16]),             // BitsPerSample
        shorts(259, &[1]),              // Compression: none
        shorts(262, &[interpretation]), // PhotometricInterpretation
        text(271, &frame.maker),
        text(272, &frame.model),
        long(STRIP_OFFSETS, 0),
        shorts(274, &[1]), // Orientation: upright
        shorts(277, &[1]), // SamplesPerPixel
        long(278, height), // RowsPerStrip
        long(279, size as u32),
        shorts(284, &[1]), // PlanarConfiguration
        text(305, concat!("spectra ", env!("CARGO_PKG_VERSION"))),
        exposure(33_434, frame.exposure_time_s),
        shorts(34_855, &[frame.iso.round() as u16]), // ISOSpeedRatings
        bytes(50_706, &[1, 4, 0, 0]),                // DNGVersion
        bytes(50_707, &[1, 1, 0, 0]),                // DNGBackwardVersion
        text(50_708, &format!("{} {}", frame.maker, frame.model)),
        shorts(50_714, &[frame.black_level]),
        long(50_717, u32::from(frame.white_level)),
    ];
    if let Some(pattern) = frame.pattern {
        let matrix: Vec<f64> = frame.camera_from_xyz.iter().flatten().copied().collect();
        fields.extend([
            shorts(33_421, &[2, 2]),             // CFARepeatPatternDim
            bytes(33_422, &pattern),             // CFAPattern
            bytes(50_710, &[0, 1, 2]),           // CFAPlaneColor
            shorts(50_711, &[1]),                // CFALayout: rectangular
            signed_rationals(50_721, &matrix),   // ColorMatrix1
            rationals(50_728, &frame.neutral),   // AsShotNeutral
            shorts(50_778, &[frame.illuminant]), // CalibrationIlluminant1
        ]);
    }
    fields.sort_by_key(|f| f.tag);
    const START: usize = 8;
    let values_at = START + 2 + fields.len() * 12 + 4;
    let beside = |f: &Field| if f.bytes.len() > 4 { f.bytes.len().next_multiple_of(2) } else { 0 };
    let strip_at = (values_at + fields.iter().map(beside).sum::<usize>()).next_multiple_of(16);
    let mut out = b"II*\0".to_vec();
    out.extend((START as u32).to_le_bytes());
    out.extend((fields.len() as u16).to_le_bytes());
    let mut values = Vec::new();
    for field in &mut fields {
        if field.tag == STRIP_OFFSETS {
            field.bytes = (strip_at as u32).to_le_bytes().to_vec();
        }
        out.extend(field.tag.to_le_bytes());
        out.extend(field.kind.to_le_bytes());
        out.extend(field.count.to_le_bytes());
        if field.bytes.len() <= 4 {
            let mut value = field.bytes.clone();
            value.resize(4, 0);
            out.extend(value);
        } else {
            out.extend(((values_at + values.len()) as u32).to_le_bytes());
            values.extend(&field.bytes);
            values.resize(values.len().next_multiple_of(2), 0);
        }
    }
    out.extend([0; 4]); // no further directory
    out.extend(values);
    out.resize(strip_at, 0);
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> RawFrame {
        RawFrame {
            width_px: 6,
            height_px: 4,
            values: (0..24).map(|i| 512 + i * 601).collect(),
            pattern: Some([0, 1, 1, 2]),
            black_level: 512,
            white_level: 16_383,
            camera_from_xyz: [[0.9, -0.3, -0.1], [-0.4, 1.2, 0.2], [-0.1, 0.3, 0.6]],
            neutral: [0.5, 1.0, 0.7],
            illuminant: 21,
            maker: "spectra".into(),
            model: "test".into(),
            exposure_time_s: 0.008,
            iso: 100.0,
        }
    }

    /// Read back by hand as TIFF 6.0 says: the directory is sorted, and the strip holds the values.
    #[test]
    fn the_strip_is_where_the_directory_says() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.dng");
        write_dng(&path, &frame()).expect("written");
        let bytes = std::fs::read(&path).expect("there");
        let short = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
        let long = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        assert_eq!((&bytes[..4], long(4)), (&b"II*\0"[..], 8));
        let entries: Vec<usize> = (0..usize::from(short(8))).map(|i| 10 + 12 * i).collect();
        let tags: Vec<u16> = entries.iter().map(|at| short(*at)).collect();
        assert!(tags.windows(2).all(|w| w[0] < w[1]), "{tags:?}");
        let entry = |tag: u16| entries[tags.iter().position(|t| *t == tag).expect("the tag")];
        let strip = long(entry(273) + 8) as usize;
        assert_eq!(bytes.len(), strip + 48);
        let values: Vec<u16> = (0..24).map(|i| short(strip + 2 * i)).collect();
        assert_eq!(values, frame().values);
        let matrix = long(entry(50_721) + 8) as usize;
        assert_eq!((long(matrix + 8) as i32, long(matrix + 12)), (-300_000, 1_000_000));
        let time = long(entry(33_434) + 8) as usize;
        assert_eq!((long(time), long(time + 4)), (1, 125));
        assert_eq!(bytes[entry(33_422) + 8..][..4], [0, 1, 1, 2]);
    }

    #[test]
    fn frames_of_another_size_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut short = frame();
        short.values.pop();
        assert!(matches!(write_dng(&folder.path().join("a.dng"), &short), Err(WriteError::Format { .. })));
    }
}
