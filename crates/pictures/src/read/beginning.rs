//! What the beginning of a picture file says: enough to place it, without its pixels.

use super::decode::{self, Kind};
use super::header::Header;
use super::linear::{Choice, Trouble};
use super::{exr, jpeg, tiff};
use spectra_core::resources::{Found, ResourceError};

/// The beginning of a JPEG that its decoder is shown: it reads all that it is given, and the size stands before the pixels.
const BEGINNING_BYTES: u64 = 4 << 20;

/// Reads the header of a file, and no pixels: those formats apart that a library unpacks as it opens them. A JPEG is looked
/// through to its end, since its decoder does not tell when the end is missing.
///
/// # Errors
/// What is wrong with it.
pub fn header(found: &Found, choice: Choice<'_>) -> Result<Header, Trouble> {
    let io = |error: ResourceError| Trouble::file(error.to_string());
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
