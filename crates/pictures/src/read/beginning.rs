//! Reads the header of a picture file: its size and shape, without its pixels.

use super::decode::{self, Kind};
use super::header::Header;
use super::linear_picture::{FileProblem, ReadOptions};
use super::{exr, jpeg, tiff};
use spectra_core::resources::{FoundFile, ResourceError};

/// Number of bytes at the start of a JPEG that its decoder receives: it reads all that it is given, and the size comes before the pixels.
const BEGINNING_BYTES: u64 = 4 << 20;

/// Reads the size and shape of a picture file without its pixels. The linked library still unpacks the pixels of some formats. A
/// JPEG is scanned to its end, because its decoder does not report a missing end.
///
/// # Errors
/// What is wrong with the file.
pub fn header(found: &FoundFile, choice: ReadOptions<'_>) -> Result<Header, FileProblem> {
    let io = |error: ResourceError| FileProblem::file(error.to_string());
    let bytes = found.size_bytes().map_err(io)?;
    let beginning = found.read(64).map_err(io)?;
    let kind = decode::kind(&beginning, choice)?;
    let without_preview = if kind == decode::TIFF { tiff::without_preview(found)? } else { None };
    let found = without_preview.as_ref().unwrap_or(found);
    let header = match kind {
        Kind::Exr => return exr::header(found.open().map_err(io)?, bytes, choice),
        Kind::Native(format) => {
            let is_jpeg = format == image::ImageFormat::Jpeg;
            if is_jpeg {
                jpeg::refuse_unless_whole(found)?;
                let beginning = found.read(BEGINNING_BYTES).map_err(io)?;
                decode::native_header(std::io::Cursor::new(beginning), format, found, choice)?
            } else {
                decode::native_header(found.open().map_err(io)?, format, found, choice)?
            }
        }
        Kind::Foreign => return decode::foreign_header(found, choice, None),
    };
    header.or_else(|why| decode::foreign_header(found, choice, Some(&why)))
}
