//! Color profiles for pictures: three primaries, a white and one curve (ICC.1:2022, profile version 4.4).

use spectra_color::matrix::Matrix;
use spectra_color::{Adaptation, RgbSpace, Transfer};

/// XYZ of D50, the white of the profile connection space (ICC.1:2022, 7.2.16).
const D50: [f64; 3] = [0.9642, 1.0, 0.8249];

/// Bytes of a profile header, and of an entry of the tag table.
const HEADER: usize = 128;
const ENTRY: usize = 12;

/// Builds the ICC display profile of the color space `space` with the curve `transfer`, adapted to D50 by Bradford. `name` is its
/// description. The profile holds no date and no name of a machine: equal arguments give equal bytes.
#[must_use]
pub fn display_profile(space: &RgbSpace, name: &str, transfer: Transfer) -> Vec<u8> {
    let adaptation = Adaptation::Bradford.matrix(space.white_xyz(), D50);
    let column = |i: usize| {
        let unit = [0, 1, 2].map(|k| if k == i { 1.0 } else { 0.0 });
        xyz(spectra_color::matrix::apply(&adaptation, space.to_xyz(unit)))
    };
    let curve = parametric(transfer);
    let tags: [(&[u8; 4], Vec<u8>); 10] = [
        (b"desc", text(name)),
        (b"cprt", text("CC0 1.0: no rights reserved")),
        (b"wtpt", xyz(D50)),
        (b"chad", chad(&adaptation)),
        (b"rXYZ", column(0)),
        (b"gXYZ", column(1)),
        (b"bXYZ", column(2)),
        (b"rTRC", curve.clone()),
        (b"gTRC", curve.clone()),
        (b"bTRC", curve),
    ];
    let mut table = (tags.len() as u32).to_be_bytes().to_vec();
    let mut data: Vec<u8> = Vec::new();
    let first = HEADER + 4 + ENTRY * tags.len();
    let mut placed: Vec<(usize, &[u8])> = Vec::new();
    for (name, content) in &tags {
        // The three curves share one copy.
        let known = placed.iter().find(|(_, other)| *other == content.as_slice()).map(|(at, _)| *at);
        let at = known.unwrap_or(first + data.len());
        if known.is_none() {
            data.extend(content);
            data.resize(data.len().next_multiple_of(4), 0);
            placed.push((at, content));
        }
        table.extend_from_slice(*name);
        table.extend((at as u32).to_be_bytes());
        table.extend((content.len() as u32).to_be_bytes());
    }
    let mut profile = header(first + data.len());
    profile.extend(table);
    profile.extend(data);
    profile
}

/// Builds the header of a profile of `size` bytes.
fn header(size: usize) -> Vec<u8> {
    let mut bytes = vec![0; HEADER];
    let mut put = |at: usize, what: &[u8]| bytes[at..at + what.len()].copy_from_slice(what);
    put(0, &(size as u32).to_be_bytes());
    put(8, &[4, 0x40, 0, 0]);
    put(12, b"mntrRGB XYZ ");
    // A date is required; this one is the date of the standard.
    put(24, &[2022_u16, 5, 1, 0, 0, 0].map(u16::to_be_bytes).concat());
    put(36, b"acsp");
    // Rendering intent: media-relative colorimetric.
    put(64, &1_u32.to_be_bytes());
    put(68, &D50.map(fixed).concat());
    bytes
}

/// Encodes a fixed-point number of 16.16 bits.
fn fixed(value: f64) -> [u8; 4] {
    ((value * 65_536.0).round() as i32).to_be_bytes()
}

fn xyz(value: [f64; 3]) -> Vec<u8> {
    [b"XYZ \0\0\0\0".to_vec(), value.map(fixed).concat()].concat()
}

fn chad(matrix: &Matrix) -> Vec<u8> {
    [b"sf32\0\0\0\0".to_vec(), matrix.as_flattened().iter().flat_map(|v| fixed(*v)).collect()].concat()
}

/// Encodes a text in English.
fn text(value: &str) -> Vec<u8> {
    let letters: Vec<u8> = value.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let mut bytes = b"mluc\0\0\0\0".to_vec();
    bytes.extend([1_u32, 12].map(u32::to_be_bytes).concat());
    bytes.extend(b"enUS");
    bytes.extend([letters.len() as u32, 28].map(u32::to_be_bytes).concat());
    bytes.extend(letters);
    bytes
}

/// Encodes the curve from code value to light: (a x + b)^g from d on, c x below.
fn parametric(transfer: Transfer) -> Vec<u8> {
    let [kind, parameters]: [&[f64]; 2] = match transfer {
        Transfer::Linear => [&[0.0], &[1.0]],
        Transfer::Srgb => [&[3.0], &[2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.040_45]],
        Transfer::Rec2020 => [&[3.0], &[1.0 / 0.45, 1.0 / 1.099_297, 0.099_297 / 1.099_297, 1.0 / 4.5, 0.081_243]],
    };
    let mut bytes = b"para\0\0\0\0".to_vec();
    bytes.extend((kind[0] as u16).to_be_bytes());
    bytes.extend([0, 0]);
    bytes.extend(parameters.iter().flat_map(|v| fixed(*v)));
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn long(bytes: &[u8], at: usize) -> usize {
        u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]) as usize
    }

    /// Reads the profile back as ICC.1:2022 says: sizes, signatures, and the numbers of sRGB2014.icc (ICC, 2015). The colorants of
    /// sRGB_v4_ICC_preference differ.
    #[test]
    fn the_profile_is_read_back() {
        let bytes = display_profile(RgbSpace::srgb(), "sRGB", Transfer::Srgb);
        assert_eq!(long(&bytes, 0), bytes.len());
        assert_eq!(&bytes[36..40], b"acsp");
        let tag = |name: &[u8; 4]| {
            let entry =
                (0..long(&bytes, HEADER)).map(|i| HEADER + 4 + i * ENTRY).find(|at| &bytes[*at..at + 4] == name);
            let at = long(&bytes, entry.expect("there") + 4);
            assert!(at.is_multiple_of(4) && at + long(&bytes, entry.expect("there") + 8) <= bytes.len());
            at
        };
        let number = |at: usize| f64::from(long(&bytes, at) as u32 as i32) / 65_536.0;
        for (name, want) in [
            (b"rXYZ", [0.4361, 0.2225, 0.0139]),
            (b"gXYZ", [0.3851, 0.7169, 0.0971]),
            (b"bXYZ", [0.1431, 0.0606, 0.7141]),
        ] {
            let at = tag(name) + 8;
            for (i, want) in want.into_iter().enumerate() {
                assert!((number(at + 4 * i) - want).abs() < 2e-4, "{name:?} {i}: {}", number(at + 4 * i));
            }
        }
        // The primaries add up to the white of the profile connection space.
        for i in 0..3 {
            let sum: f64 = [b"rXYZ", b"gXYZ", b"bXYZ"].map(|name| number(tag(name) + 8 + 4 * i)).iter().sum();
            assert!((sum - D50[i]).abs() < 5e-5, "{i}: {sum}");
        }
        assert_eq!(tag(b"rTRC"), tag(b"bTRC"));
        let curve = tag(b"gTRC");
        let [g, a, b, c, d] = [0, 1, 2, 3, 4].map(|i| number(curve + 12 + 4 * i));
        for code in [0.02, 0.2, 0.7, 1.0] {
            let light = if code >= d { libm::pow(a * code + b, g) } else { c * code };
            assert!((light - Transfer::Srgb.decode(code)).abs() < 5e-5, "{code}: {light}");
        }
    }
}
