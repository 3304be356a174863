//! Checks the sizes of the pictures of a TIFF file before its decoder sees them. The decoder multiplies the numbers of tiles and strips
//! without checking for overflow.

use super::super::linear_picture::{FileProblem, check_size};
use std::io::{self, BufRead, Seek, SeekFrom};

/// Largest number of pictures of a file that are checked; the decoder goes no further unless asked.
const MOST: usize = 256;
const WIDTH: u64 = 256;
const HEIGHT: u64 = 257;

/// Refuses a file that states a picture larger than the limits.
pub(in crate::read) fn check(reader: impl BufRead + Seek) -> Result<(), FileProblem> {
    // Other faults of the file are reported when it is read.
    let all = sides(reader).unwrap_or_default();
    all.into_iter().try_for_each(|[width, height]| check_size(width, height))
}

/// A file whose numbers are read in its byte order.
struct Numbers<R> {
    reader: R,
    is_little: bool,
}

impl<R: BufRead + Seek> Numbers<R> {
    fn number(&mut self, bytes: usize) -> io::Result<u64> {
        let mut all = [0; 8];
        self.reader.read_exact(&mut all[..bytes])?;
        if !self.is_little {
            all[..bytes].reverse();
        }
        Ok(u64::from_le_bytes(all))
    }
}

/// Returns width and height of each picture, as far as the file states them.
fn sides(mut reader: impl BufRead + Seek) -> io::Result<Vec<[u64; 2]>> {
    let mut order = [0; 2];
    reader.read_exact(&mut order)?;
    let mut file = Numbers { reader, is_little: order == *b"II" };
    // BigTIFF, for files of more than 4 GB, has wider numbers.
    let is_big = file.number(2)? == 43;
    let [wide, counted] = if is_big { [8, 8] } else { [4, 2] };
    if is_big {
        file.number(4)?;
    }
    let mut all = Vec::new();
    let mut at = file.number(wide)?;
    while at != 0 && all.len() < MOST {
        file.reader.seek(SeekFrom::Start(at))?;
        let mut sides = [0; 2];
        for _ in 0..file.number(counted)?.min(1 << 16) {
            let (tag, kind, count) = (file.number(2)?, file.number(2)?, file.number(wide)?);
            // Sizes are stored in one, two, four or eight bytes; fields of other types cannot hold a size.
            let bytes =
                [(1, 1), (3, 2), (4, 4), (16, 8)].iter().find(|(own, _)| *own == kind).map_or(0, |(_, bytes)| *bytes);
            let is_side = [WIDTH, HEIGHT].contains(&tag) && count == 1 && (1..=wide).contains(&bytes);
            let value = if is_side { file.number(bytes)? } else { 0 };
            file.reader.seek_relative((wide - if is_side { bytes } else { 0 }) as i64)?;
            if is_side {
                sides[usize::from(tag == HEIGHT)] = value;
            }
        }
        all.push(sides);
        at = file.number(wide)?;
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    /// Builds a file of one picture in tiles of one pixel, or in strips of one row, with many planes.
    fn file(is_big: bool, sides: [u32; 2], is_tiled: bool) -> Vec<u8> {
        let mut bytes = if is_big { b"MM\x00\x2b\x00\x08\x00\x00".to_vec() } else { b"II\x2a\x00".to_vec() };
        let number = |value: u64, size: usize| -> Vec<u8> {
            if is_big { value.to_be_bytes()[8 - size..].to_vec() } else { value.to_le_bytes()[..size].to_vec() }
        };
        let wide = if is_big { 8 } else { 4 };
        let tiles: &[(u64, u64)] =
            if is_tiled { &[(322, 1), (323, 1), (324, 8), (325, 1)] } else { &[(273, 8), (278, 1), (279, 1)] };
        let mut entries = vec![(256, u64::from(sides[0])), (257, u64::from(sides[1])), (258, 8), (259, 1), (262, 1)];
        entries.extend(tiles);
        entries.extend([(277, 65_535), (284, 2)]);
        entries.sort_unstable();
        let start = bytes.len() + wide;
        bytes.extend(number(start as u64, wide));
        bytes.extend(number(entries.len() as u64, if is_big { 8 } else { 2 }));
        for (tag, value) in entries {
            bytes.extend([number(tag, 2), number(4, 2), number(1, wide)].concat());
            // The value is stored at the start of its field.
            bytes.extend(number(value, 4));
            bytes.extend(vec![0; wide - 4]);
        }
        bytes.extend(vec![0; wide]);
        bytes
    }

    #[test]
    fn sides_that_no_picture_has_are_seen_first() {
        for is_big in [false, true] {
            for is_tiled in [false, true] {
                for sides in [[u32::MAX, u32::MAX], [16, u32::MAX], [70_000, 1]] {
                    let bytes = file(is_big, sides, is_tiled);
                    let trouble = check(Cursor::new(&bytes)).expect_err("refused");
                    assert!(trouble.text.contains("pixels; at most"), "{}", trouble.text);
                    let read = crate::read::decode::decode_bytes(&bytes, Default::default()).expect_err("refused");
                    assert_eq!(read.text, trouble.text);
                }
                let small = file(is_big, [16, 16], is_tiled);
                assert!(check(Cursor::new(&small)).is_ok() && check(Cursor::new(&small[..30])).is_ok());
            }
        }
        assert!(check(Cursor::new(b"II")).is_ok());
        // A directory that points to itself does not loop forever.
        let mut bytes = file(false, [16, 16], false);
        let last = bytes.len() - 4;
        bytes[last..].copy_from_slice(&8_u32.to_le_bytes());
        assert!(check(Cursor::new(&bytes)).is_ok());
    }
}
