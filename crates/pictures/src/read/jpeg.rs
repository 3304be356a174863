//! Checks whether a JPEG file is complete. Decoders fill missing parts with gray without an error.

use super::linear_picture::FileProblem;
use spectra_core::resources::FoundFile;
use std::io::{self, BufRead, Read};

/// Refuses a file that ends before its picture does. Reads the file once and keeps none of it.
///
/// # Errors
/// The file is truncated, or cannot be read.
pub(super) fn refuse_unless_whole(found: &FoundFile) -> Result<(), FileProblem> {
    let file = found.open().map_err(|error| FileProblem::file(error.to_string()))?;
    match is_whole(file) {
        Ok(true) => Ok(()),
        Ok(false) => Err(FileProblem::file("the file is truncated")
            .hint("copy, download or save it again: the missing part would be gray")),
        Err(error) => Err(FileProblem::file(error.to_string())),
    }
}

/// Returns whether the file reaches the end of its picture (marker EOI; ITU-T T.81, B.1 and B.2). Skips segments by their lengths, so that
/// the end of an embedded thumbnail does not count.
fn is_whole(mut file: impl BufRead) -> io::Result<bool> {
    const EOI: u8 = 0xd9;
    let mut bytes = [0; 2];
    if !fill(&mut file, &mut bytes)? {
        return Ok(false);
    }
    loop {
        // The next marker is 0xff, possibly repeated, and a number. In the data of a scan, 0xff 0 is a value, and 0xd0 to 0xd7 only restart
        // the scan.
        file.skip_until(0xff)?;
        let mut marker = [0xff];
        while marker[0] == 0xff {
            if !fill(&mut file, &mut marker)? {
                return Ok(false);
            }
        }
        match marker[0] {
            0 | 0x01 | 0xd0..=0xd8 => {}
            EOI => return Ok(true),
            // A segment. After the header of a scan (SOS) its data follow, and are searched for the next marker.
            _ => {
                if !fill(&mut file, &mut bytes)? {
                    return Ok(false);
                }
                let rest = u64::from(u16::from_be_bytes(bytes)).saturating_sub(2);
                io::copy(&mut file.by_ref().take(rest), &mut io::sink())?;
            }
        }
    }
}

/// Returns the number of components of the picture from its frame header (B.2.2); `None` if there is no such header.
pub(super) fn components(mut file: impl BufRead) -> Option<u8> {
    /// Offset of the number of components after the segment length: bits per sample, height and width come first.
    const COMPONENTS_AT: usize = 5;
    let mut marker = [0; 2];
    fill(&mut file, &mut marker).ok().filter(|is| *is)?;
    loop {
        let mut marker = [0xff];
        while marker[0] == 0xff {
            fill(&mut file, &mut marker).ok().filter(|is| *is)?;
        }
        let mut length = [0; 2];
        fill(&mut file, &mut length).ok().filter(|is| *is)?;
        let length = u64::from(u16::from_be_bytes(length)).saturating_sub(2);
        match marker[0] {
            // The markers of code tables, JPEG extensions and arithmetic conditioning lie among those of frames.
            0xc0..=0xcf if !matches!(marker[0], 0xc4 | 0xc8 | 0xcc) => {
                let mut frame = [0; COMPONENTS_AT + 1];
                fill(&mut file, &mut frame).ok().filter(|is| *is)?;
                return Some(frame[COMPONENTS_AT]);
            }
            // The data of a scan follow, and no frame.
            0xda => return None,
            _ => {
                io::copy(&mut file.by_ref().take(length), &mut io::sink()).ok()?;
                let mut next = [0];
                fill(&mut file, &mut next).ok().filter(|is| *is && next[0] == 0xff)?;
            }
        }
    }
}

/// Fills `bytes` from the file; returns whether there were enough bytes.
fn fill(file: &mut impl Read, bytes: &mut [u8]) -> io::Result<bool> {
    match file.read_exact(bytes) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(false),
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_is_found_and_that_of_a_thumbnail_is_not() {
        // SOI, APP1 of 6 bytes that holds an EOI, SOS of 4 bytes, data with a stuffed 0xff and a restart, EOI.
        let whole = b"\xff\xd8\xff\xe1\x00\x06\xff\xd8\xff\xd9\xff\xda\x00\x04\x01\x02abc\xff\x00d\xff\xd0e\xff\xd9";
        let is_whole = |bytes: &[u8]| is_whole(bytes).expect("read from memory");
        assert!(is_whole(whole));
        for cut in 2..whole.len() {
            assert!(!is_whole(&whole[..cut]), "{cut}");
        }
        let trailer = [&whole[..], b"more"].concat();
        assert!(is_whole(&trailer));
    }
}
