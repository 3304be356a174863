//! Reads exposure and primaries from the header of a Radiance picture (G. Ward, "Radiance file formats", 1992).
//!
//! `EXPOSURE=` is the factor by which the values were multiplied; the factors of several lines multiply. `PRIMARIES=` are the x, y of red,
//! green, blue and white.

use super::primaries::to_srgb;
use spectra_color::matrix::Matrix;
use spectra_color::{RgbSpace, Transfer};
use std::io::BufRead;

/// Longest header that is searched, bytes.
const LONGEST: u64 = 1 << 16;

/// Returns the matrix from the values of a file to linear sRGB light, white to white. `None` if no conversion is needed, or if the header
/// states nothing sound.
pub(super) fn to_light(file: impl BufRead) -> Option<Matrix> {
    let mut exposure = 1.0;
    let mut primaries = None;
    for line in file.take(LONGEST).split(b'\n') {
        let line = line.ok()?;
        let line = String::from_utf8_lossy(&line);
        let line = line.trim();
        if line.is_empty() {
            break;
        }
        if let Some(factor) = line.strip_prefix("EXPOSURE=").and_then(|value| value.trim().parse::<f64>().ok()) {
            exposure *= factor;
        } else if let Some(values) = line.strip_prefix("PRIMARIES=") {
            let values: Vec<f64> = values.split_whitespace().filter_map(|value| value.parse().ok()).collect();
            primaries = <[f64; 8]>::try_from(values).ok();
        }
    }
    let sound = exposure.is_finite() && exposure > 0.0 && (1e-12..1e12).contains(&exposure);
    let gain = if sound { 1.0 / exposure } else { 1.0 };
    let space = primaries.filter(|p| p.iter().skip(1).step_by(2).all(|y| *y > 1e-4)).and_then(|p| {
        let [red, green, blue, white] = [0, 1, 2, 3].map(|i| [p[2 * i], p[2 * i + 1]]);
        to_srgb(&RgbSpace::new("PRIMARIES", [red, green, blue], white, Transfer::Linear))
    });
    let sane = |matrix: &Matrix| matrix.as_flattened().iter().all(|v| v.abs() < 100.0);
    match space.filter(sane) {
        None if gain == 1.0 => None,
        None => Some([[gain, 0.0, 0.0], [0.0, gain, 0.0], [0.0, 0.0, gain]]),
        Some(matrix) => Some(matrix.map(|row| row.map(|v| v * gain))),
    }
}

#[cfg(test)]
mod tests {
    use crate::read::decode::decode_bytes;
    use crate::read::linear_picture::ReadOptions;

    /// Reads a picture of one pixel, (0.5, 0.25, 0.125), with these header lines.
    fn read(header: &str) -> [f32; 3] {
        let bytes = [b"#?RADIANCE\n", header.as_bytes(), b"FORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n", &[128, 64, 32, 128]]
            .concat();
        decode_bytes(&bytes, ReadOptions::default()).expect("a picture").rgb[0]
    }

    #[test]
    fn exposures_multiply_and_primaries_count() {
        let plain = read("");
        for (i, want) in [0.5, 0.25, 0.125].into_iter().enumerate() {
            assert!((plain[i] - want).abs() < 2e-3, "{plain:?}");
        }
        for (got, plain) in read("EXPOSURE=2\nEXPOSURE= 4.0\n").into_iter().zip(plain) {
            assert!((got * 8.0 - plain).abs() < 1e-6);
        }
        // Primaries of Rec. 709 change nothing; those of Display P3 act by the matrix of CSS Color Module Level 4.
        assert_eq!(read("PRIMARIES= 0.64 0.33 0.30 0.60 0.15 0.06 0.3127 0.3290\n"), plain);
        let p3 = read("PRIMARIES= 0.68 0.32 0.265 0.69 0.15 0.06 0.3127 0.3290\n");
        let matrix = [[1.2249, -0.2249, 0.0], [-0.0421, 1.0421, 0.0], [-0.0196, -0.0786, 1.0983]];
        for (got, row) in p3.into_iter().zip(matrix) {
            let want: f32 = row.iter().zip(plain).map(|(a, b)| *a as f32 * b).sum();
            assert!((got - want).abs() < 3e-4, "{p3:?} {want}");
        }
        // Unsound header lines are ignored.
        assert_eq!(read("EXPOSURE=0\nPRIMARIES= 1 2 3\n"), plain);
    }
}
