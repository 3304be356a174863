//! Whether a JPEG is all there. Decoders fill what is missing with gray and say nothing.

/// Whether the file goes on to the end of its picture (marker EOI; ITU-T T.81, B.1 and B.2). Segments are stepped over by
/// their lengths, so that the end of a thumbnail inside of one is not taken for it.
pub(super) fn is_whole(bytes: &[u8]) -> bool {
    const EOI: u8 = 0xd9;
    let mut at = 2;
    loop {
        // The next marker: 0xff, which may come several times, and a number. In the data of a scan 0xff 0 is a value, and
        // 0xd0 to 0xd7 only restart it.
        let Some(found) = bytes.get(at..).and_then(|rest| rest.iter().position(|b| *b == 0xff)) else { return false };
        at += found + 1;
        match bytes.get(at) {
            None => return false,
            Some(0 | 0x01 | 0xd0..=0xd8 | 0xff) => continue,
            Some(&EOI) => return true,
            // Of a scan (SOS) the data follow its header, and are looked through for the next marker.
            Some(_) => {
                let Some(&[high, low]) = bytes.get(at + 1..at + 3) else { return false };
                let length = usize::from(u16::from_be_bytes([high, low]));
                at += 1 + length;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_is_found_and_that_of_a_thumbnail_is_not() {
        // SOI, APP1 of 6 bytes that holds an EOI, SOS of 4 bytes, data with a stuffed 0xff and a restart, EOI.
        let whole = b"\xff\xd8\xff\xe1\x00\x06\xff\xd8\xff\xd9\xff\xda\x00\x04\x01\x02abc\xff\x00d\xff\xd0e\xff\xd9";
        assert!(is_whole(whole));
        for cut in 2..whole.len() {
            assert!(!is_whole(&whole[..cut]), "{cut}");
        }
        let trailer = [&whole[..], b"more"].concat();
        assert!(is_whole(&trailer));
    }
}
