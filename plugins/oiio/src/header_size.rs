//! Reads the size from the header of formats that the library unpacks or allocates when it opens them.

/// Width and height in pixels; `None` for other formats or without a header.
pub(crate) fn size(format: &str, bytes: &[u8]) -> Option<[u64; 2]> {
    match format {
        "jpeg2000" => jpeg_2000(bytes),
        "gif" => gif(bytes),
        "webp" => webp(bytes),
        "psd" => psd(bytes),
        _ => None,
    }
}

fn big(bytes: &[u8], at: usize) -> Option<u64> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(four.iter().fold(0, |all, byte| all << 8 | u64::from(*byte)))
}

fn little(bytes: &[u8], at: usize, count: usize) -> Option<u64> {
    let some = bytes.get(at..at.checked_add(count)?)?;
    Some(some.iter().rev().fold(0, |all, byte| all << 8 | u64::from(*byte)))
}

/// Reads the JPEG 2000 size (ISO/IEC 15444-1, A.5.1). The marker SIZ directly follows SOC; the codestream starts the file or lies in a box
/// of it.
fn jpeg_2000(bytes: &[u8]) -> Option<[u64; 2]> {
    let start = bytes.windows(4).position(|four| four == [0xff, 0x4f, 0xff, 0x51])?;
    let [x1, y1, x0, y0] = [8, 12, 16, 20].map(|at| big(bytes, start + at));
    Some([x1?.saturating_sub(x0?), y1?.saturating_sub(y0?)])
}

/// Reads the GIF size (GIF89a specification, section 18).
fn gif(bytes: &[u8]) -> Option<[u64; 2]> {
    bytes.starts_with(b"GIF8").then_some(())?;
    Some([little(bytes, 6, 2)?, little(bytes, 8, 2)?])
}

/// Reads the WebP size from any of the three kinds of first chunk (RFC 9649).
fn webp(bytes: &[u8]) -> Option<[u64; 2]> {
    match bytes.get(12..16)? {
        b"VP8X" => Some([little(bytes, 24, 3)? + 1, little(bytes, 27, 3)? + 1]),
        b"VP8L" => {
            let packed = little(bytes, 21, 4)?;
            Some([(packed & 0x3fff) + 1, (packed >> 14 & 0x3fff) + 1])
        }
        _ => Some([little(bytes, 26, 2)? & 0x3fff, little(bytes, 28, 2)? & 0x3fff]),
    }
}

/// Reads the Photoshop size (Adobe Photoshop File Formats Specification, "File Header Section"), which states rows first.
fn psd(bytes: &[u8]) -> Option<[u64; 2]> {
    Some([big(bytes, 18)?, big(bytes, 14)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_stand_where_the_standards_say() {
        let mut jp2 = vec![0; 40];
        // Marker, length 47, capabilities 0, then Xsiz, Ysiz, XOsiz, YOsiz.
        jp2.extend([0xff, 0x4f, 0xff, 0x51, 0, 47, 0, 0]);
        for value in [300_u32, 200, 20, 10] {
            jp2.extend(value.to_be_bytes());
        }
        assert_eq!(size("jpeg2000", &jp2), Some([280, 190]));
        assert_eq!(size("jpeg2000", &jp2[..50]), None);
        assert_eq!(size("gif", b"GIF89a\x40\x01\xf0\x00"), Some([320, 240]));
        // RFC 9649, section 2.7: width and height minus one, 24 bits each.
        let mut webp = *b"RIFF\0\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0\0\0\0\0\0\0";
        webp[24..30].copy_from_slice(&[0x7f, 0x02, 0, 0xdf, 0x01, 0]);
        assert_eq!(size("webp", &webp), Some([640, 480]));
        assert_eq!(size("dpx", b"SDPX"), None);
    }
}
