//! Decodes picture files to linear light, and withstands hostile files.

use super::cmyk::Cmyk;
use super::encoding::Encoding;
use super::header::Header;
use super::linear_picture::{FileProblem, LinearPicture, MAX_SIDE, NotRead, ReadOptions, check_size};
use super::tags::Tags;
use super::to_light::linear;
use super::{exr, jpeg, library_formats, orientation, tiff};
use image::metadata::Orientation;
use image::{ColorType, ImageDecoder, ImageFormat, ImageReader, Limits};
use spectra_color::Transfer;
use spectra_core::resources::{FoundFile, ResourceError};
use std::io::{BufRead, Seek};

/// Upper limit of pixels per byte, except for WebP: deflate reaches about 1 032 to 1, at one byte per pixel or less.
const MAX_PIXELS_PER_BYTE: u64 = 1_100 * 8;

/// Decodes an OpenEXR, PNG, JPEG, TIFF, WebP, BMP or Radiance HDR file, recognized by its content, or any other file that OpenImageIO
/// reads, recognized by the extension of its name.
///
/// Unless the file or `choice` says otherwise, integers are taken as sRGB-encoded (8 bits: 255 is 1) and floating point as linear.
/// Unless the file says otherwise, colors of integer files are not multiplied by alpha, and those of floating point files are, as in
/// OpenEXR.
///
/// # Errors
/// What is wrong with the file.
pub fn decode(found: &FoundFile, choice: ReadOptions<'_>) -> Result<LinearPicture, FileProblem> {
    let said = choice.transfer.map(Encoding::named).transpose()?;
    let bytes = found.size_bytes().map_err(io)?;
    let kind = kind(&found.read(64).map_err(io)?, choice)?;
    let without_preview = if kind == TIFF { tiff::without_preview(found)? } else { None };
    let found = without_preview.as_ref().unwrap_or(found);
    match kind {
        Kind::Exr => exr::decode(found.open().map_err(io)?, bytes, choice, true),
        Kind::Native(format) => match native(found, format, choice, said.clone()) {
            Ok(linear) => Ok(linear),
            Err(NotRead::Trouble(trouble)) => Err(trouble),
            Err(NotRead::Unsupported(why)) => {
                library_formats::decode(found, choice, said).map_err(|trouble| library_formats::also(&why, trouble))
            }
        },
        Kind::Foreign => library_formats::decode(found, choice, said),
    }
}

/// Reads the header of a file that [`decode`] reads with OpenImageIO. `why` is the reason why this crate did not read it.
///
/// # Errors
/// What is wrong with the file.
pub(super) fn foreign_header(
    found: &FoundFile,
    choice: ReadOptions<'_>,
    why: Option<&str>,
) -> Result<Header, FileProblem> {
    let said = choice.transfer.map(Encoding::named).transpose()?;
    let header = library_formats::header(found, choice, said);
    header.map_err(|trouble| why.map_or(trouble.clone(), |why| library_formats::also(why, trouble)))
}

fn io(error: ResourceError) -> FileProblem {
    FileProblem::file(error.to_string())
}

/// The reader of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    Exr,
    Native(ImageFormat),
    Foreign,
}

/// The kind of file that may hold several pictures.
pub(super) const TIFF: Kind = Kind::Native(ImageFormat::Tiff);

/// Determines the reader from the first bytes, and checks that the choice suits it.
///
/// # Errors
/// An empty file; a layer, a depth or a transfer that this kind of file cannot have.
pub(super) fn kind(beginning: &[u8], choice: ReadOptions<'_>) -> Result<Kind, FileProblem> {
    if beginning.is_empty() {
        return Err(FileProblem::file("the file is empty")
            .hint("is the file complete? Save it again as OpenEXR, PNG, JPEG, TIFF or HDR"));
    }
    let said = choice.transfer.map(Encoding::named).transpose()?;
    if beginning.starts_with(&exr::MAGIC) {
        if said.is_some() {
            return Err(FileProblem::at("transfer", "an OpenEXR file holds linear light").hint("leave `transfer` out"));
        }
        return Ok(Kind::Exr);
    }
    if choice.layer.is_some() {
        return Err(FileProblem::at("layer", "only an OpenEXR file has layers").hint("leave `layer` out"));
    }
    if choice.depth.is_some() {
        return Err(FileProblem::at("depth", "only an OpenEXR file has a depth channel")
            .hint("name a file that has it: `depth: {file: ..., channel: Z}`"));
    }
    // BigTIFF, for files of more than 4 GB, has 43 instead of 42 after the byte order.
    let is_big_tiff = beginning.starts_with(b"II\x2b\0") || beginning.starts_with(b"MM\0\x2b");
    let guessed = if is_big_tiff { Some(ImageFormat::Tiff) } else { image::guess_format(beginning).ok() };
    let format = guessed.filter(ImageFormat::reading_enabled);
    Ok(format.map_or(Kind::Foreign, Kind::Native))
}

/// Opens a decoder and reads the header, from at least the beginning of the file.
fn decoder<'a>(
    reader: impl BufRead + Seek + 'a,
    format: ImageFormat,
    found: &'a FoundFile,
) -> Result<impl ImageDecoder + 'a, NotRead> {
    let is_tiff = format == ImageFormat::Tiff;
    let widened = if is_tiff { tiff::Widened::new(found.open().map_err(io)?) } else { None };
    let inks = Cmyk::new(found.open().map_err(io)?, found, format);
    let decoder: Box<dyn ImageDecoder + 'a> = match (widened, inks) {
        (Some(widened), _) => Box::new(widened),
        (None, Some(inks)) => Box::new(inks),
        (None, None) => Box::new(ImageReader::with_format(reader, format).into_decoder()?),
    };
    let bytes = found.size_bytes().map_err(io)?;
    let (width, height) = decoder.dimensions();
    check_size(u64::from(width), u64::from(height))?;
    // WebP codes a uniform area in almost no bytes; its sides are limited to 16 384 pixels.
    let is_packed = format == ImageFormat::WebP;
    if !is_packed && u64::from(width) * u64::from(height) > bytes * MAX_PIXELS_PER_BYTE {
        let text = format!("the header states {width} x {height} pixels, but a file of {bytes} bytes cannot hold them");
        return Err(FileProblem::file(text).into());
    }
    Ok(decoder)
}

/// Reads the header of a file from its beginning. The inner `Err` says why this variant is not supported here.
pub(super) fn native_header<'a>(
    reader: impl BufRead + Seek + 'a,
    format: ImageFormat,
    found: &'a FoundFile,
    choice: ReadOptions<'_>,
) -> Result<Result<Header, String>, FileProblem> {
    let mut decoder = match decoder(reader, format, found) {
        Ok(decoder) => decoder,
        Err(NotRead::Trouble(trouble)) => return Err(trouble),
        Err(NotRead::Unsupported(why)) => return Ok(Err(why)),
    };
    let (width, height) = decoder.dimensions();
    let turned = orientation::is_on_its_side(orientation(&mut decoder));
    let [width, height] = if turned { [height, width] } else { [width, height] };
    let tags = Tags::of(found, format, &mut decoder);
    let clips = tags.is_long || !matches!(decoder.color_type(), ColorType::Rgb32F | ColorType::Rgba32F);
    let pixel_aspect = orientation::seen_aspect(tags.pixel_aspect, turned);
    let said = choice.transfer.map(Encoding::named).transpose()?;
    let encoding = said.or_else(|| tags.encoding.clone()).unwrap_or(Encoding::Curve(Transfer::Srgb));
    // A user who states the curve has already dealt with the warning.
    let doubts = tags.warning.filter(|_| choice.transfer.is_none()).into_iter().collect();
    Ok(Ok(Header {
        width,
        height,
        overscan: [0; 2],
        pixel_aspect,
        clips,
        is_for_display: clips && encoding.is_for_display(),
        is_jpeg: format == ImageFormat::Jpeg,
        warnings: doubts,
    }))
}

/// Orientation as TIFF 6.0 numbers it; upright if the file does not state a sound one.
fn orientation(decoder: &mut impl ImageDecoder) -> u8 {
    decoder.orientation().unwrap_or(Orientation::NoTransforms).to_exif()
}

fn native(
    found: &FoundFile,
    format: ImageFormat,
    choice: ReadOptions<'_>,
    said: Option<Encoding>,
) -> Result<LinearPicture, NotRead> {
    if format == ImageFormat::Jpeg {
        jpeg::refuse_unless_whole(found)?;
    }
    let mut decoder = decoder(found.open().map_err(io)?, format, found)?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    // As much memory as the picture needs, and as much again plus 64 MiB for the decoder.
    let spare_bytes = decoder.total_bytes().saturating_add(64 << 20);
    limits.max_alloc = Some(decoder.total_bytes().saturating_add(spare_bytes));
    decoder.set_limits(limits)?;
    let orientation = orientation(&mut decoder);
    let tags = Tags::of(found, format, &mut decoder);
    let tags = Tags { encoding: said.or(tags.encoding), ..tags };
    let plain = tiff::Plain::new(found.open().map_err(io)?, &decoder, format, spare_bytes)?;
    linear(decoder, plain, orientation, choice, &tags)
}

/// Returns whether a file is an OpenEXR file.
///
/// # Errors
/// The file cannot be read.
pub fn is_exr(found: &FoundFile) -> Result<bool, FileProblem> {
    Ok(found.read(64).map_err(io)?.starts_with(&exr::MAGIC))
}

/// Reads only the depth channel of an OpenEXR file, which need not hold light.
///
/// # Errors
/// What is wrong with the file.
pub fn depth(found: &FoundFile, choice: ReadOptions<'_>) -> Result<LinearPicture, FileProblem> {
    if !is_exr(found)? {
        return Err(FileProblem::file("only an OpenEXR file has a depth channel"));
    }
    exr::decode(found.open().map_err(io)?, found.size_bytes().map_err(io)?, choice, false)
}

/// Returns the overscan of the depth channel that `choice` names: how many pixels it has beyond the picture on each side,
/// horizontally and vertically. 0 if the file cannot be read.
pub fn depth_overscan(found: &FoundFile, choice: ReadOptions<'_>) -> [u32; 2] {
    let read = || -> Result<[u32; 2], FileProblem> {
        if !is_exr(found)? {
            return Ok([0; 2]);
        }
        exr::depth_overscan(found.open().map_err(io)?, found.size_bytes().map_err(io)?, choice)
    };
    read().unwrap_or_default()
}

/// Runs [`decode`] on bytes in memory.
#[cfg(test)]
pub(super) fn decode_bytes(bytes: &[u8], choice: ReadOptions<'_>) -> Result<LinearPicture, FileProblem> {
    decode(&FoundFile::bytes("a file".to_owned(), bytes.to_vec().into()), choice)
}
