//! Detects from Exif whether a picture is in Adobe RGB (1998). Cameras write no color profile (DCF 2.0, JEITA CP-3461).

use super::encoding::Encoding;
use super::primaries::to_srgb;
use super::profile::Stated;
use spectra_color::{RgbSpace, Transfer};

/// Tags of Exif 2.3 that are read.
const EXIF_FOLDER: u16 = 0x8769;
const COLOR_SPACE: u16 = 0xa001;
const INTEROPERABILITY_FOLDER: u16 = 0xa005;
const INTEROPERABILITY_INDEX: u16 = 1;
/// Value of `ColorSpace` for any space but sRGB.
const UNCALIBRATED: u32 = 0xffff;

/// Returns Adobe RGB (1998) if the file states it: an uncalibrated space, and the optional color space of DCF, `R03`.
pub(super) fn stated(exif: &[u8]) -> Option<Stated> {
    let exif = exif.strip_prefix(b"Exif\0\0").unwrap_or(exif);
    let folder = entry(exif, long(exif, 4)?, EXIF_FOLDER)?.value;
    let other = entry(exif, folder, INTEROPERABILITY_FOLDER)?.value;
    let is_uncalibrated = entry(exif, folder, COLOR_SPACE).is_some_and(|entry| entry.value == UNCALIBRATED);
    let is_adobe = entry(exif, other, INTEROPERABILITY_INDEX).is_some_and(|entry| entry.bytes.starts_with(b"R03"));
    let space = RgbSpace::new(
        "Adobe RGB (1998)",
        [[0.64, 0.33], [0.21, 0.71], [0.15, 0.06]],
        [0.3127, 0.3290],
        Transfer::Linear,
    );
    (is_uncalibrated && is_adobe).then(|| (Encoding::Gamma(563.0 / 256.0), to_srgb(&space)))
}

struct Entry<'a> {
    value: u32,
    /// The four bytes of the entry in which a short value is stored directly.
    bytes: &'a [u8],
}

/// Finds the entry of a tag in the directory at the offset `folder`.
fn entry(exif: &[u8], folder: u32, tag: u16) -> Option<Entry<'_>> {
    const SHORT: u16 = 3;
    let start = folder as usize;
    let count = usize::from(short(exif, start)?);
    (0..count).find_map(|i| {
        let at = start.checked_add(2 + 12 * i)?;
        let bytes = exif.get(at + 8..at + 12)?;
        let value = if short(exif, at + 2)? == SHORT { u32::from(short(exif, at + 8)?) } else { long(exif, at + 8)? };
        (short(exif, at)? == tag).then_some(Entry { value, bytes })
    })
}

fn is_big(exif: &[u8]) -> bool {
    exif.starts_with(b"MM")
}

fn short(exif: &[u8], at: usize) -> Option<u16> {
    let bytes = exif.get(at..at.checked_add(2)?)?.try_into().ok()?;
    Some(if is_big(exif) { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) })
}

fn long(exif: &[u8], at: usize) -> Option<u32> {
    let bytes = exif.get(at..at.checked_add(4)?)?.try_into().ok()?;
    Some(if is_big(exif) { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::decode::decode_bytes;
    use crate::read::linear_picture::ReadOptions;

    /// Builds Exif data as cameras write them, in either byte order.
    fn exif(is_big: bool, color_space: u16, index: &[u8; 4]) -> Vec<u8> {
        let short = |v: u16| if is_big { v.to_be_bytes() } else { v.to_le_bytes() };
        let long = |v: u32| if is_big { v.to_be_bytes() } else { v.to_le_bytes() };
        let mut bytes = if is_big { b"MM".to_vec() } else { b"II".to_vec() };
        bytes.extend(short(42));
        bytes.extend(long(8));
        let mut folder = |entries: &[(u16, u16, u32, [u8; 4])]| {
            bytes.extend(short(entries.len() as u16));
            for (tag, kind, count, value) in entries {
                bytes.extend(short(*tag));
                bytes.extend(short(*kind));
                bytes.extend(long(*count));
                bytes.extend(value);
            }
            bytes.extend(long(0));
        };
        let [a, b] = short(color_space);
        folder(&[(EXIF_FOLDER, 4, 1, long(26))]);
        folder(&[(COLOR_SPACE, 3, 1, [a, b, 0, 0]), (INTEROPERABILITY_FOLDER, 4, 1, long(56))]);
        folder(&[(INTEROPERABILITY_INDEX, 2, 4, *index)]);
        bytes
    }

    #[test]
    fn adobe_rgb_is_known_by_two_signs() {
        for is_big in [false, true] {
            assert!(stated(&exif(is_big, 0xffff, b"R03\0")).is_some());
            assert!(stated(&exif(is_big, 1, b"R03\0")).is_none());
            assert!(stated(&exif(is_big, 0xffff, b"R98\0")).is_none());
        }
        let whole = exif(false, 0xffff, b"R03\0");
        (0..whole.len()).for_each(|cut| drop(stated(&whole[..cut])));
        let mut hostile = whole;
        hostile[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(stated(&hostile).is_none());
    }

    /// A green of Adobe RGB in a JPEG without a profile: light (0.2, 0.6, 0.3) in Adobe RGB is another color in sRGB, by the matrices of
    /// both spaces.
    #[test]
    fn its_colors_are_those_of_the_space() {
        let light = [0.2, 0.6, 0.3_f64];
        let code = light.map(|v| (255.0 * v.powf(256.0 / 563.0)).round() as u8);
        let mut bytes = std::io::Cursor::new(Vec::new());
        let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 100);
        image::ImageEncoder::set_exif_metadata(&mut encoder, exif(true, 0xffff, b"R03\0")).expect("kept");
        encoder.encode_image(&image::RgbImage::from_pixel(16, 16, image::Rgb(code))).expect("written");
        let got = decode_bytes(&bytes.into_inner(), ReadOptions::default()).expect("a picture").rgb[0];
        // Adobe RGB (1998), 4.3.5.3, to XYZ, and IEC 61966-2-1 back: red 1.3983, -0.3983; blue -0.0429, 1.0429.
        let want = [1.3983 * light[0] - 0.3983 * light[1], light[1], -0.0429 * light[1] + 1.0429 * light[2]];
        for (got, want) in got.into_iter().zip(want) {
            assert!((f64::from(got) - want).abs() < 0.01, "{got} {want}");
        }
    }
}
