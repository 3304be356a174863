//! Decodes picture files to linear light, and withstands hostile files.

use super::cmyk::Cmyk;
use super::encoding::Encoding;
use super::header::Header;
use super::linear_picture::{
    FileProblem, LinearPicture, MAX_SIDE, OPAQUE, ReadOptions, check_size, finite, mend, over_black, positive,
};
use super::tags::Tags;
use super::{exr, jpeg, library_formats, orientation, tiff};
use image::metadata::Orientation;
use image::{ColorType, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use rayon::prelude::*;
use spectra_color::Transfer;
use spectra_color::matrix::apply;
use spectra_core::resources::{FoundFile, ResourceError};
use std::io::{BufRead, Seek};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

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

/// Reasons why a file of a known kind is not read.
enum NotRead {
    Trouble(FileProblem),
    /// A sound variant of the kind that this crate does not support.
    Unsupported(String),
}

impl From<FileProblem> for NotRead {
    fn from(trouble: FileProblem) -> Self {
        Self::Trouble(trouble)
    }
}

impl From<ImageError> for NotRead {
    fn from(error: ImageError) -> Self {
        match error {
            ImageError::Unsupported(why) => Self::Unsupported(why.to_string()),
            other => Self::Trouble(FileProblem::file(other.to_string())),
        }
    }
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
    let pixel_aspect = seen(tags.pixel_aspect, turned);
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

/// Width over height of a pixel as the picture is seen.
fn seen(stored: Option<f64>, turned: bool) -> f64 {
    stored.map_or(1.0, |aspect| if turned { 1.0 / aspect } else { aspect })
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

/// Returns how many pixels the chosen depth channel has beyond the picture on each side, horizontally and vertically; 0 if the file cannot
/// be read.
pub fn depth_overscan(found: &FoundFile, choice: ReadOptions<'_>) -> [u32; 2] {
    let read = || -> Result<[u32; 2], FileProblem> {
        if !is_exr(found)? {
            return Ok([0; 2]);
        }
        exr::depth_overscan(found.open().map_err(io)?, found.size_bytes().map_err(io)?, choice)
    };
    read().unwrap_or_default()
}

/// Number of pixels that a thread converts at a time.
const PIXELS_A_TASK: usize = 1 << 14;

/// Sample types of a decoded pixel.
#[derive(Clone, Copy)]
enum Samples {
    Bytes,
    Shorts,
    /// 32-bit integers, which a TIFF may have.
    Longs,
    Floats,
}

/// Converts the picture of a decoder to linear light, upright.
///
/// Code values are read into the end of the buffer that the light will fill, and expanded from there. A picture thus takes 12 bytes per
/// pixel and no more (and 4 for alpha, if wanted).
/// A picture stored on its side is turned in the same buffer: its code values if there is room in front of them, otherwise its light.
fn linear<R: BufRead + Seek>(
    decoder: impl ImageDecoder,
    plain: Option<tiff::Plain<R>>,
    orientation: u8,
    choice: ReadOptions<'_>,
    tags: &Tags,
) -> Result<LinearPicture, NotRead> {
    let ReadOptions { alpha: cover, is_plain, .. } = choice;
    const LIGHT: usize = size_of::<[f32; 3]>();
    let color = decoder.color_type();
    let samples = match color {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => Samples::Bytes,
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => Samples::Shorts,
        ColorType::Rgb32F | ColorType::Rgba32F if tags.is_long => Samples::Longs,
        ColorType::Rgb32F | ColorType::Rgba32F => Samples::Floats,
        other => return Err(NotRead::Unsupported(format!("pixels of type {other:?} cannot be read"))),
    };
    let (size, count) = (usize::from(color.bytes_per_pixel()), usize::from(color.channel_count()));
    let (width, height) = decoder.dimensions();
    let pixels = width as usize * height as usize;
    let said = tags.encoding.as_ref();
    let of_integers = said.cloned().unwrap_or(Encoding::Curve(Transfer::Srgb));
    let to_srgb = tags.to_srgb.filter(|_| color.has_color() && !is_plain);
    let table = match samples {
        Samples::Bytes => of_integers.table(256),
        Samples::Shorts => of_integers.table(65_536),
        Samples::Longs | Samples::Floats => Vec::new(),
    };
    let is_float = matches!(samples, Samples::Floats);
    // Integers are not multiplied by alpha, and floating point is, unless the file says otherwise.
    let is_multiplied = tags.is_multiplied.unwrap_or(false) && !is_plain;
    let is_light_multiplied = is_plain || (is_float && tags.is_multiplied.unwrap_or(true));
    // Returns the light of a pixel and its alpha.
    let light = |pixel: &[u8]| -> ([f32; 3], f32) {
        let short = |c: usize| u16::from_ne_bytes([pixel[2 * c], pixel[2 * c + 1]]);
        let four = |c: usize| [pixel[4 * c], pixel[4 * c + 1], pixel[4 * c + 2], pixel[4 * c + 3]];
        let float = |c: usize| f32::from_ne_bytes(four(c));
        let long = |c: usize| f64::from(u32::from_ne_bytes(four(c))) / f64::from(u32::MAX);
        let gray = count < 3;
        let cover = match samples {
            _ if count % 2 == 1 => 1.0,
            Samples::Bytes => f32::from(pixel[count - 1]) / 255.0,
            Samples::Shorts => f32::from(short(count - 1)) / 65_535.0,
            Samples::Longs => long(count - 1) as f32,
            Samples::Floats => positive(float(count - 1)).min(1.0),
        };
        let rgb = [0, 1, 2].map(|c| {
            let c = if gray { 0 } else { c };
            // A multiplied code is the code of the covering color times alpha.
            let uncovered = |code: f64| of_integers.light((code / f64::from(cover)).min(1.0));
            match samples {
                Samples::Bytes if is_multiplied && cover > 0.0 => uncovered(f64::from(pixel[c]) / 255.0),
                Samples::Shorts if is_multiplied && cover > 0.0 => uncovered(f64::from(short(c)) / 65_535.0),
                Samples::Longs if is_multiplied && cover > 0.0 => uncovered(long(c)),
                Samples::Bytes => table[usize::from(pixel[c])],
                Samples::Shorts => table[usize::from(short(c))],
                Samples::Longs => of_integers.light(long(c)),
                Samples::Floats => said.map_or(float(c), |encoding| encoding.light(f64::from(float(c)))),
            }
        });
        let rgb = to_srgb.map_or(rgb, |matrix| {
            let converted = apply(&matrix, rgb.map(f64::from)).map(|v| v as f32);
            if matches!(samples, Samples::Floats) { converted } else { converted.map(finite) }
        });
        if count % 2 == 1 || is_light_multiplied {
            return (rgb, cover);
        }
        (rgb.map(|v| v * cover), cover)
    };
    let mut rgb: Vec<[f32; 3]> = vec![[0.0; 3]; pixels];
    let mut alpha = if count % 2 == 0 && cover { vec![0.0_f32; pixels] } else { Vec::new() };
    let memory: &mut [u8] = bytemuck::cast_slice_mut(&mut rgb);
    // Number of pixels that are not opaque.
    let thin = AtomicUsize::new(0);
    let stored_size = [width as usize, height as usize];
    let keep = |memory: &mut [u8], alpha: &mut [f32], i: usize, pixel: &[u8]| {
        let (light, cover) = light(pixel);
        if cover < OPAQUE {
            thin.fetch_add(1, Relaxed);
        }
        memory[i * LIGHT..][..LIGHT].copy_from_slice(bytemuck::bytes_of(&light));
        if let Some(at) = alpha.get_mut(i) {
            *at = cover;
        }
    };
    let mut is_upright = orientation == 1;
    if size <= LIGHT {
        let start = pixels * (LIGHT - size);
        match plain {
            Some(mut plain) => plain.read(&mut memory[start..], size, size / count)?,
            None => decoder.read_image(&mut memory[start..])?,
        }
        if !is_upright && 2 * size <= LIGHT {
            let (before, codes) = memory.split_at_mut(start);
            let room = start - codes.len();
            for (i, pixel) in before[room..].chunks_exact_mut(size).enumerate() {
                pixel.copy_from_slice(&codes[orientation::stored(i, stored_size, orientation) * size..][..size]);
            }
            memory.copy_within(room..start, start);
            is_upright = true;
        }
        let mut done = 0;
        // Light in front of the codes that are still to come does not overwrite them. Each pass converts as many pixels as fit there: three
        // quarters, then three quarters of the rest, and so on.
        while alpha.is_empty() && size < LIGHT {
            let (free, codes) = memory.split_at_mut(start + done * size);
            let clear = (free.len() / LIGHT - done).min(pixels - done);
            if clear < PIXELS_A_TASK {
                break;
            }
            let to = free[done * LIGHT..][..clear * LIGHT].par_chunks_mut(PIXELS_A_TASK * LIGHT);
            to.zip(codes.par_chunks(PIXELS_A_TASK * size)).for_each(|(to, codes)| {
                let mut own = 0;
                for (to, pixel) in to.chunks_exact_mut(LIGHT).zip(codes.chunks_exact(size)) {
                    let (light, cover) = light(pixel);
                    own += usize::from(cover < OPAQUE);
                    to.copy_from_slice(bytemuck::bytes_of(&light));
                }
                thin.fetch_add(own, Relaxed);
            });
            done += clear;
        }
        let mut pixel = [0_u8; LIGHT];
        for i in done..pixels {
            pixel[..size].copy_from_slice(&memory[start + i * size..][..size]);
            keep(memory, &mut alpha, i, &pixel[..size]);
        }
    } else if let Some(mut plain) = plain {
        if plain.is_planar() {
            // Colors go first to where the light will be; a pixel is complete when its alpha arrives.
            plain.read(memory, LIGHT, size / count)?;
            let mut pixel = vec![0_u8; size];
            plain.runs(count - 1, size - LIGHT, |first, codes| {
                for (i, cover) in codes.chunks_exact(size - LIGHT).enumerate() {
                    pixel[..LIGHT].copy_from_slice(&memory[(first + i) * LIGHT..][..LIGHT]);
                    pixel[LIGHT..].copy_from_slice(cover);
                    keep(memory, &mut alpha, first + i, &pixel);
                }
            })?;
        } else {
            plain.runs(0, size, |first, codes| {
                for (i, pixel) in codes.chunks_exact(size).enumerate() {
                    keep(memory, &mut alpha, first + i, pixel);
                }
            })?;
        }
    } else {
        let mut codes = vec![0; pixels * size];
        decoder.read_image(&mut codes)?;
        for (i, pixel) in codes.chunks_exact(size).enumerate() {
            keep(memory, &mut alpha, i, pixel);
        }
    }
    let mut doubts = Vec::new();
    if matches!(samples, Samples::Floats) && !is_plain {
        doubts.extend(mend(&mut rgb));
        rgb.iter_mut().flatten().for_each(|value| *value = finite(*value));
    }
    if !cover && !is_plain {
        doubts.extend(over_black(thin.load(Relaxed), pixels));
    }
    if !is_upright {
        orientation::upright(&mut rgb, stored_size, orientation);
        orientation::upright(alpha.as_chunks_mut::<1>().0, stored_size, orientation);
    }
    let turned = orientation::is_on_its_side(orientation);
    Ok(LinearPicture {
        width: if turned { height } else { width },
        height: if turned { width } else { height },
        pixel_aspect: seen(tags.pixel_aspect, turned),
        rgb,
        alpha: (!alpha.is_empty()).then_some(alpha),
        depth: None,
        // Primaries of another space map white to white except for the last digits.
        clipped_at: (!matches!(samples, Samples::Floats))
            .then(|| of_integers.clipped_at() * if to_srgb.is_some() { 1.0 - 1e-5 } else { 1.0 }),
        warnings: doubts,
    })
}

/// Runs [`decode`] on bytes in memory.
#[cfg(test)]
pub(super) fn decode_bytes(bytes: &[u8], choice: ReadOptions<'_>) -> Result<LinearPicture, FileProblem> {
    decode(&FoundFile::bytes("a file".to_owned(), bytes.to_vec().into()), choice)
}

#[cfg(test)]
mod tests {
    use super::decode_bytes as decode;
    use super::*;
    use image::{ImageFormat, Rgb, RgbImage};
    use std::io::Cursor;

    fn png(picture: &RgbImage) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn white_of_eight_bits_is_one_and_rows_start_at_the_top() {
        let mut picture = RgbImage::new(3, 2);
        picture.put_pixel(2, 0, Rgb([255, 255, 255]));
        picture.put_pixel(0, 1, Rgb([188, 0, 0]));
        let linear = decode(&png(&picture), ReadOptions::default()).unwrap();
        assert_eq!((linear.width, linear.height), (3, 2));
        assert_eq!(linear.rgb[2], [1.0, 1.0, 1.0]);
        // IEC 61966-2-1: ((188/255 + 0.055) / 1.055)^2.4 = 0.50289.
        assert!((linear.rgb[3][0] - 0.502_89).abs() < 1e-5);
    }

    /// BMP and lossless WebP give the same picture as PNG, including alpha.
    #[test]
    fn bmp_and_webp_are_read() {
        let picture = image::RgbaImage::from_fn(5, 4, |x, y| {
            image::Rgba([(x * 50) as u8, (y * 60) as u8, 128, if x == 3 { 100 } else { 255 }])
        });
        let opaque = image::DynamicImage::ImageRgba8(picture.clone()).to_rgb8();
        let of = |format, alpha: bool| {
            let mut bytes = Cursor::new(Vec::new());
            let written =
                if alpha { picture.write_to(&mut bytes, format) } else { opaque.write_to(&mut bytes, format) };
            written.expect("written");
            let found = FoundFile::bytes("picture".to_owned(), bytes.into_inner().into());
            super::decode(&found, ReadOptions { alpha: true, ..ReadOptions::default() }).expect("a picture")
        };
        for alpha in [false, true] {
            let png = of(ImageFormat::Png, alpha);
            assert_eq!(png.alpha.is_some(), alpha);
            for format in [ImageFormat::WebP, ImageFormat::Bmp] {
                assert_eq!(of(format, alpha), png, "{format:?}");
            }
        }
    }

    /// A lossy WebP of a smooth picture differs from its original PNG (`xtask/picture_samples.py`) by less than 2 in CIELAB on average.
    #[test]
    fn lossy_webp_is_near_its_original() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/");
        let [lossy, plain] = ["lossy.webp", "lossy.png"].map(|name| {
            let bytes = std::fs::read(format!("{folder}{name}")).expect("a sample");
            decode(&bytes, ReadOptions::default()).expect("a picture")
        });
        assert_eq!((lossy.width, lossy.height), (plain.width, plain.height));
        let lab = |light: &[f32; 3]| {
            let space = spectra_color::RgbSpace::srgb();
            let xyz = apply(&space.xyz_from_rgb, light.map(f64::from));
            spectra_color::lab(xyz, space.white_xyz())
        };
        let differences = lossy.rgb.iter().zip(&plain.rgb).map(|(a, b)| {
            let [a, b] = [lab(a), lab(b)];
            (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum::<f64>().sqrt()
        });
        let mean = differences.sum::<f64>() / lossy.rgb.len() as f64;
        assert!(mean < 2.0 && mean > 0.0, "{mean}");
    }

    /// Builds a TIFF of 20 x 19 pixels whose sample c of pixel (x, y) is `of(c, x, y)`. It has a plane for each channel or interleaved
    /// pixels, in strips of 6 rows or tiles of 16 x 16.
    fn tiff_of(channels: usize, is_planar: bool, is_tiled: bool, of: impl Fn(usize, usize, usize) -> f32) -> Vec<u8> {
        use ::tiff::{encoder::TiffEncoder, tags::Tag};
        const SIZE: [usize; 2] = [20, 19];
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
        let mut picture = encoder.image_directory().unwrap();
        let chunk = if is_tiled { [16, 16] } else { [SIZE[0], 6] };
        let (mut offsets, mut counts) = (Vec::new(), Vec::new());
        let planes: Vec<_> =
            if is_planar { (0..channels).map(|c| c..c + 1).collect() } else { std::iter::once(0..channels).collect() };
        for plane in planes {
            for y0 in (0..SIZE[1]).step_by(chunk[1]) {
                let rows = if is_tiled { 16 } else { chunk[1].min(SIZE[1] - y0) };
                for x0 in (0..SIZE[0]).step_by(chunk[0]) {
                    let mut samples = Vec::new();
                    for (y, x) in (y0..y0 + rows).flat_map(|y| (x0..x0 + chunk[0]).map(move |x| (y, x))) {
                        samples.extend(plane.clone().map(|c| of(c, x, y)));
                    }
                    offsets.push(picture.write_data(&samples[..]).unwrap() as u32);
                    counts.push(4 * samples.len() as u32);
                }
            }
        }
        let all = |value: u16| vec![value; channels];
        picture.write_tag(Tag::ImageWidth, SIZE[0] as u32).unwrap();
        picture.write_tag(Tag::ImageLength, SIZE[1] as u32).unwrap();
        picture.write_tag(Tag::BitsPerSample, &all(32)[..]).unwrap();
        picture.write_tag(Tag::Compression, 1_u16).unwrap();
        picture.write_tag(Tag::PhotometricInterpretation, 2_u16).unwrap();
        picture.write_tag(Tag::SamplesPerPixel, channels as u16).unwrap();
        picture.write_tag(Tag::PlanarConfiguration, if is_planar { 2_u16 } else { 1 }).unwrap();
        if channels == 4 {
            picture.write_tag(Tag::ExtraSamples, 1_u16).unwrap(); // associated
        }
        picture.write_tag(Tag::SampleFormat, &all(3)[..]).unwrap();
        let [at, size] = if is_tiled {
            picture.write_tag(Tag::TileWidth, 16_u32).unwrap();
            picture.write_tag(Tag::TileLength, 16_u32).unwrap();
            [Tag::TileOffsets, Tag::TileByteCounts]
        } else {
            picture.write_tag(Tag::RowsPerStrip, chunk[1] as u32).unwrap();
            [Tag::StripOffsets, Tag::StripByteCounts]
        };
        picture.write_tag(at, &offsets[..]).unwrap();
        picture.write_tag(size, &counts[..]).unwrap();
        picture.finish().unwrap();
        bytes.into_inner()
    }

    #[test]
    fn planes_are_read_as_pixels_are() {
        let of = |c: usize, x: usize, y: usize| (1 + c) as f32 / 8.0 + x as f32 / 64.0 + y as f32;
        for (channels, is_tiled) in [(3, false), (4, false), (3, true), (4, true)] {
            let [planes, pixels] = [true, false].map(|is_planar| {
                let cover = |c, x, y| if c == 3 { x as f32 / 20.0 } else { of(c, x, y) };
                let choice = ReadOptions { alpha: true, ..ReadOptions::default() };
                decode(&tiff_of(channels, is_planar, is_tiled, cover), choice).unwrap()
            });
            assert_eq!((planes.width, planes.height), (20, 19));
            assert!(planes.rgb == pixels.rgb && planes.alpha == pixels.alpha, "{channels} {is_tiled}");
            assert_eq!(planes.rgb[18 * 20 + 7], [0, 1, 2].map(|c| of(c, 7, 18)), "{channels} {is_tiled}");
            assert_eq!(planes.alpha.map(|cover| cover[18 * 20 + 7]), (channels == 4).then_some(7.0 / 20.0));
        }
    }

    /// A picture with clear and half-clear pixels gives a warning if alpha is not wanted. An opaque picture gives none.
    #[test]
    fn cover_that_is_lost_is_said() {
        for side in [2, 300] {
            let of = |x: u32, y: u32| [200, 100, 50, if y > 0 { 255 } else { [0, 128][x as usize % 2] }];
            let picture = image::RgbaImage::from_fn(side, side, |x, y| image::Rgba(of(x, y)));
            let mut bytes = Cursor::new(Vec::new());
            picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
            let read = decode(bytes.get_ref(), ReadOptions::default()).unwrap();
            let [doubt] = &read.warnings[..] else { panic!("{:?}", read.warnings) };
            assert!(doubt.text.contains(&format!("{side} of its {} pixels", side * side)), "{}", doubt.text);
            let covered = decode(bytes.get_ref(), ReadOptions { alpha: true, ..ReadOptions::default() }).unwrap();
            assert!(covered.warnings.is_empty() && covered.alpha.is_some());
        }
        let mut bytes = Cursor::new(Vec::new());
        image::RgbaImage::from_pixel(3, 2, image::Rgba([9, 9, 9, 255])).write_to(&mut bytes, ImageFormat::Png).unwrap();
        assert!(decode(bytes.get_ref(), ReadOptions::default()).unwrap().warnings.is_empty());
    }

    #[test]
    fn broken_and_hostile_files_are_refused() {
        let good = png(&RgbImage::new(64, 64));
        for cut in [0, 1, 7, 8, 20, 33, 50, good.len() - 13] {
            assert!(decode(&good[..cut], ReadOptions::default()).is_err(), "cut at {cut}");
        }
        // A header that claims 60 000 x 60 000 pixels, and one that claims 2^31 per side.
        for side in [60_000_u32, 0x7fff_ffff] {
            let mut bad = good.clone();
            bad[16..20].copy_from_slice(&side.to_be_bytes());
            bad[20..24].copy_from_slice(&side.to_be_bytes());
            assert!(decode(&bad, ReadOptions::default()).is_err());
        }
        assert!(decode(b"GIF89a not read", ReadOptions::default()).is_err());
    }

    #[test]
    fn the_encoding_that_is_said_is_taken() {
        let bytes = png(&RgbImage::from_pixel(2, 1, Rgb([0, 51, 255])));
        let said = |transfer| decode(&bytes, ReadOptions { transfer: Some(transfer), ..ReadOptions::default() });
        assert_eq!(said("linear").unwrap().rgb[0], [0.0, 0.2, 1.0]);
        // ITU-R BT.709: ((0.2 + 0.099) / 1.099)^(1/0.45) = 0.05543.
        assert!((said("rec709").unwrap().rgb[0][1] - 0.055_43).abs() < 1e-4);
        let trouble = said("srbg").expect_err("not known");
        assert_eq!((trouble.key, trouble.hint.is_some()), ("transfer", true));
        let exr = exr::MAGIC.to_vec();
        assert_eq!(
            decode(&exr, ReadOptions { transfer: Some("srgb"), ..ReadOptions::default() }).err().unwrap().key,
            "transfer"
        );
    }

    /// TIFF 6.0, `Orientation`: 6 means that the first stored row is the right side of the picture.
    #[test]
    fn a_picture_lies_as_its_orientation_says() {
        let mut stored = RgbImage::new(3, 2);
        stored.put_pixel(0, 0, Rgb([255, 0, 0]));
        stored.put_pixel(2, 0, Rgb([0, 255, 0]));
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 100);
        // TIFF header, one entry: tag 274, short, 6.
        let exif = b"MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0".to_vec();
        image::ImageEncoder::set_exif_metadata(&mut encoder, exif).unwrap();
        let stored = image::imageops::resize(&stored, 48, 32, image::imageops::FilterType::Nearest);
        encoder.encode_image(&stored).unwrap();
        let upright = decode(&bytes.into_inner(), ReadOptions::default()).unwrap();
        assert_eq!((upright.width, upright.height), (32, 48));
        let at = |column: usize, row: usize| upright.rgb[row * 32 + column];
        assert!(at(28, 4)[0] > 0.9 && at(28, 4)[1] < 0.05, "the first pixel is at the top right");
        assert!(at(28, 44)[1] > 0.9 && at(4, 4)[0] < 0.05);
    }

    #[test]
    fn without_a_library_other_formats_say_how_to_get_it() {
        if crate::library::library().is_some() {
            return;
        }
        for (bytes, name) in [(&b"SDPX"[..], "scan.DPX"), (b"GIF89a\0\0\0\0", "dance.gif")] {
            let trouble = decode(bytes, ReadOptions { name, ..ReadOptions::default() }).expect_err("not read");
            assert!(trouble.hint.is_some_and(|hint| hint.contains("--features oiio")), "{name}: {}", trouble.text);
        }
        // The message does not suggest a library for unknown or broken files.
        for name in ["notes.txt", "broken.png", "nothing"] {
            let trouble = decode(b"some text", ReadOptions { name, ..ReadOptions::default() }).expect_err("not read");
            assert!(trouble.hint.is_none_or(|hint| !hint.contains("oiio")), "{name}");
        }
    }
}
