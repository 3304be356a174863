//! Decoding of text: UTF-8, UTF-16 in either byte order with or without a byte order mark, or Latin-1.

/// Decodes the bytes of a file as text: UTF-8, UTF-16 or Latin-1. Invalid UTF-16 becomes the replacement character.
#[must_use]
pub fn text(bytes: &[u8]) -> String {
    match bytes {
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
        [0xef, 0xbb, 0xbf, rest @ ..] => eight_bit(rest),
        _ => {
            // The text of a lens file is nearly all ASCII: in UTF-16 every other byte is then 0.
            let start = &bytes[..bytes.len().min(64)];
            let zeros = |offset: usize| start.iter().skip(offset).step_by(2).filter(|b| **b == 0).count();
            let most = start.len() / 4 + 1;
            if start.len() >= 4 && zeros(1) >= most && zeros(0) == 0 {
                utf16(bytes, u16::from_le_bytes)
            } else if start.len() >= 4 && zeros(0) >= most && zeros(1) == 0 {
                utf16(bytes, u16::from_be_bytes)
            } else {
                eight_bit(bytes)
            }
        }
    }
}

fn utf16(bytes: &[u8], order: fn([u8; 2]) -> u16) -> String {
    let units = bytes.chunks_exact(2).map(|pair| order([pair[0], pair[1]]));
    char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}

fn eight_bit(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        // Decode as ISO 8859-1: each byte is the character of that number.
        Err(_) => bytes.iter().map(|b| char::from(*b)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_encodings_of_a_name() {
        let wanted = "NAME Ø30 mm, f=26.5 mm";
        let le: Vec<u8> = wanted.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let be: Vec<u8> = wanted.encode_utf16().flat_map(u16::to_be_bytes).collect();
        let marked = |mark: &[u8], bytes: &[u8]| [mark, bytes].concat();
        let latin: Vec<u8> = wanted.chars().map(|c| c as u8).collect();
        for bytes in [
            le.clone(),
            be.clone(),
            marked(&[0xff, 0xfe], &le),
            marked(&[0xfe, 0xff], &be),
            wanted.as_bytes().to_vec(),
            marked(&[0xef, 0xbb, 0xbf], wanted.as_bytes()),
            latin,
        ] {
            assert_eq!(text(&bytes), wanted, "{bytes:?}");
        }
    }

    #[test]
    fn odd_bytes_are_text_too() {
        assert_eq!(text(b""), "");
        assert_eq!(text(&[0xff, 0xfe, 0x41]), "");
        assert_eq!(text(&[0xff, 0xfe, 0x00, 0xd8]), "\u{fffd}");
        assert_eq!(text(&[0, 0, 0, 0, 0]), "\0\0\0\0\0");
    }
}
