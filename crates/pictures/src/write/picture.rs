//! Writes pictures for a screen as PNG, TIFF and JPEG.

use super::space::{PictureSpace, chunk};
use super::srgb8_table::Srgb8Table;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::codecs::tiff::TiffEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageError};
use rayon::prelude::*;
use spectra_color::to_u8;
use spectra_core::frame::DisplayPicture;
use spectra_core::sink::Out;
use spectra_files::{WriteError, WriteFault, write_atomically};
use std::io::{BufWriter, Write};
use std::path::Path;

/// Number of pixels that a thread encodes at a time.
const PIXELS_A_TASK: usize = 8192;

/// Writes an 8-bit PNG file at `path`: sRGB encoding, 1 becomes 255, values outside [0, 1] are clipped, no dithering.
///
/// # Errors
/// [`WriteError`]: the system refuses, or the number of pixels does not match the size.
pub fn write_png8(path: &Path, picture: &DisplayPicture) -> Result<(), WriteError> {
    write_atomically(path, |file| png8(file, picture, PictureSpace::Srgb, 1.0))
}

/// Writes an 8-bit PNG in the color space `space`: 1 becomes 255, values outside [0, 1] are clipped, no dithering.
/// Pixels are `pixel_aspect` times as wide as high; if this is not 1, the file states it.
///
/// # Errors
/// [`WriteFault`]: the system refuses, or the number of pixels does not match the size.
pub fn png8(
    out: &mut dyn Out,
    picture: &DisplayPicture,
    space: PictureSpace,
    pixel_aspect: f64,
) -> Result<(), WriteFault> {
    let bytes = if space.is_srgb() { eight(picture) } else { encoded(picture, space, |code| [to_u8(code)]) };
    png(out, picture, &bytes, ExtendedColorType::Rgb8, space, pixel_aspect)
}

/// Writes a 16-bit PNG in the color space `space`: 1 becomes 65535, values outside [0, 1] are clipped.
/// Pixels are `pixel_aspect` times as wide as high; if this is not 1, the file states it.
///
/// # Errors
/// [`WriteFault`]: the system refuses, or the number of pixels does not match the size.
pub fn png16(
    out: &mut dyn Out,
    picture: &DisplayPicture,
    space: PictureSpace,
    pixel_aspect: f64,
) -> Result<(), WriteFault> {
    let bytes = encoded(picture, space, code16);
    png(out, picture, &bytes, ExtendedColorType::Rgb16, space, pixel_aspect)
}

/// Writes a 16-bit PNG file at `path`: sRGB encoding, 1 becomes 65535, values outside [0, 1] are clipped.
///
/// # Errors
/// [`WriteError`]: the system refuses, or the number of pixels does not match the size.
pub fn write_png16(path: &Path, picture: &DisplayPicture) -> Result<(), WriteError> {
    write_atomically(path, |file| png16(file, picture, PictureSpace::Srgb, 1.0))
}

/// Writes an uncompressed 16-bit TIFF in the color space `space`: 1 becomes 65535, values outside [0, 1] are clipped. Includes a
/// color profile if there is one for the space.
///
/// # Errors
/// [`WriteFault`]: the system refuses, or the number of pixels does not match the size.
pub fn tiff16(out: &mut dyn Out, picture: &DisplayPicture, space: PictureSpace) -> Result<(), WriteFault> {
    let bytes = encoded(picture, space, code16);
    check(picture)?;
    let mut to = BufWriter::new(out);
    let (width, height) = (picture.width_px, picture.height_px);
    let mut encoder = TiffEncoder::new(&mut to);
    if let Some(profile) = space.profile() {
        encoder.set_icc_profile(profile).map_err(|error| WriteFault::Format(error.to_string()))?;
    }
    encoder.write_image(&bytes, width, height, ExtendedColorType::Rgb16).map_err(fault)?;
    Ok(to.flush()?)
}

/// Writes an 8-bit JPEG in the color space `space`, each channel at full resolution, with a color profile if there is one for the
/// space. `quality` is 1 to 100.
///
/// # Errors
/// [`WriteFault`]: the system refuses, or the number of pixels does not match the size.
pub fn jpeg(out: &mut dyn Out, picture: &DisplayPicture, space: PictureSpace, quality: u8) -> Result<(), WriteFault> {
    let bytes = if space.is_srgb() { eight(picture) } else { encoded(picture, space, |code| [to_u8(code)]) };
    check(picture)?;
    let mut to = BufWriter::new(out);
    let mut encoder = JpegEncoder::new_with_quality(&mut to, quality);
    if let Some(profile) = space.profile() {
        encoder.set_icc_profile(profile).map_err(|error| WriteFault::Format(error.to_string()))?;
    }
    encoder.write_image(&bytes, picture.width_px, picture.height_px, ExtendedColorType::Rgb8).map_err(fault)?;
    Ok(to.flush()?)
}

fn png(
    out: &mut dyn Out,
    picture: &DisplayPicture,
    bytes: &[u8],
    color: ExtendedColorType,
    space: PictureSpace,
    pixel_aspect: f64,
) -> Result<(), WriteFault> {
    check(picture)?;
    let mut to = BufWriter::new(out);
    let mut png = Vec::new();
    // Photographs, and grain above all, repeat little: fast compression gives files of the same size in a fortieth of the time.
    PngEncoder::new_with_quality(&mut png, CompressionType::Fast, FilterType::Adaptive)
        .write_image(bytes, picture.width_px, picture.height_px, color)
        .map_err(fault)?;
    // Signature and IHDR come first (PNG, third edition, 5.6). Chunks about color, and pHYs, may follow directly.
    let (head, rest) = png.split_at(8 + 25);
    to.write_all(head)?;
    to.write_all(&space.chunks())?;
    if pixel_aspect != 1.0 && (0.001..1000.0).contains(&pixel_aspect) {
        to.write_all(&physical_dimensions(pixel_aspect))?;
    }
    to.write_all(rest)?;
    Ok(to.flush()?)
}

/// Builds the chunk pHYs (PNG, third edition, 11.3.4.3) for pixels of this width over height, without a unit.
fn physical_dimensions(pixel_aspect: f64) -> Vec<u8> {
    const ACROSS: u32 = 1_000_000;
    let down = (f64::from(ACROSS) * pixel_aspect).round() as u32;
    chunk(b"pHYs", &[&ACROSS.to_be_bytes()[..], &down.to_be_bytes(), &[0]].concat())
}

/// Checks the number of pixels, because the encoders panic if it does not match the size.
fn check(picture: &DisplayPicture) -> Result<(), WriteFault> {
    let (width, height, found) = (picture.width_px, picture.height_px, picture.rgb.len());
    if found == 0 || found as u64 != u64::from(width) * u64::from(height) {
        return Err(WriteFault::Format(format!("a picture of {width} x {height} pixels cannot have {found} pixels")));
    }
    Ok(())
}

fn fault(error: ImageError) -> WriteFault {
    match error {
        ImageError::IoError(cause) => WriteFault::Io(cause),
        other => WriteFault::Format(other.to_string()),
    }
}

/// Encodes the picture in code values of a space; `code` converts a value to `N` bytes.
fn encoded<const N: usize>(
    picture: &DisplayPicture,
    space: PictureSpace,
    code: impl Fn(f64) -> [u8; N] + Sync,
) -> Vec<u8> {
    let encode = space.encoder();
    let mut bytes = vec![0; picture.rgb.len() * 3 * N];
    let rows = bytes.par_chunks_mut(PIXELS_A_TASK * 3 * N).zip(picture.rgb.par_chunks(PIXELS_A_TASK));
    rows.for_each(|(bytes, rgb)| {
        for (to, linear) in bytes.chunks_exact_mut(3 * N).zip(rgb) {
            for (to, value) in to.chunks_exact_mut(N).zip(encode(*linear)) {
                to.copy_from_slice(&code(value));
            }
        }
    });
    bytes
}

/// Encodes the picture in 8-bit sRGB.
fn eight(picture: &DisplayPicture) -> Vec<u8> {
    let codes = Srgb8Table::srgb();
    let mut bytes = vec![0; picture.rgb.len() * 3];
    bytes.par_chunks_mut(PIXELS_A_TASK * 3).zip(picture.rgb.par_chunks(PIXELS_A_TASK)).for_each(|(bytes, rgb)| {
        for (to, linear) in bytes.iter_mut().zip(rgb.as_flattened()) {
            *to = codes.code(*linear);
        }
    });
    bytes
}

/// Converts a code value to 16 bits in native byte order, as the encoders expect.
fn code16(code: f64) -> [u8; 2] {
    // The cast saturates and converts NaN to 0.
    ((code * 65_535.0 + 0.5).floor() as u16).to_ne_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> DisplayPicture {
        let rgb =
            (0..12).map(|i| [i as f32 / 11.0, 0.18, if i == 3 { f32::NAN } else { 2.0 - i as f32 * 0.3 }]).collect();
        DisplayPicture { width_px: 4, height_px: 3, rgb }
    }

    /// IEC 61966-2-1: linear 0.18 is code 0.46136, that is 118 of 255 and 30235 of 65535.
    #[test]
    fn pictures_come_back_as_srgb_codes() {
        let folder = tempfile::tempdir().expect("a folder");
        let eight = folder.path().join("a.png");
        let sixteen = [folder.path().join("b.png"), folder.path().join("c.tif")];
        write_png8(&eight, &picture()).expect("written");
        write_png16(&sixteen[0], &picture()).expect("written");
        write_atomically(&sixteen[1], |file| tiff16(file, &picture(), PictureSpace::Srgb)).expect("written");
        let read = image::open(&eight).expect("a picture").into_rgb8();
        assert_eq!(read.dimensions(), (4, 3));
        assert_eq!(read.get_pixel(0, 0).0, [0, 118, 255]);
        assert_eq!(read.get_pixel(3, 2).0, [255, 118, 0]);
        assert_eq!(read.get_pixel(3, 0).0[2], 0);
        for path in &sixteen {
            let read = image::open(path).expect("a picture").into_rgb16();
            assert_eq!(read.get_pixel(0, 0).0, [0, 30_235, 65_535], "{}", path.display());
            assert_eq!(read.get_pixel(3, 2).0, [65_535, 30_235, 0], "{}", path.display());
        }
    }

    /// A gradient comes back within a code value or two, with the profile of its space.
    #[test]
    fn a_jpeg_holds_the_picture_and_its_profile() {
        let rgb = (0..64 * 64).map(|i| [(i % 64) as f32 / 63.0, (i / 64) as f32 / 63.0, 0.18]).collect();
        let picture = DisplayPicture { width_px: 64, height_px: 64, rgb };
        for space in [PictureSpace::Srgb, PictureSpace::DisplayP3] {
            let folder = tempfile::tempdir().expect("a folder");
            let path = folder.path().join("a.jpg");
            write_atomically(&path, |file| jpeg(file, &picture, space, 95)).expect("written");
            let bytes = std::fs::read(&path).expect("bytes");
            let found = spectra_core::resources::FoundFile::bytes("a.jpg".to_owned(), bytes.into());
            let linear = crate::read::decode(&found, crate::read::ReadOptions::default()).expect("a picture");
            let codes = |v: f64| 255.0 * spectra_color::Transfer::Srgb.encode(v.clamp(0.0, 1.0));
            let pairs = linear.rgb.iter().flatten().zip(picture.rgb.iter().flatten());
            let off = pairs.map(|(a, b)| (codes(f64::from(*a)) - codes(f64::from(*b))).abs());
            let mean = off.sum::<f64>() / (3 * 64 * 64) as f64;
            println!("{space:?}: {mean:.2} of 255");
            assert!(mean < 1.5, "{space:?}: {mean}");
        }
    }

    #[test]
    fn pictures_of_no_pixels_or_no_folder_are_errors() {
        let folder = tempfile::tempdir().expect("a folder");
        let none = DisplayPicture { width_px: 0, height_px: 0, rgb: Vec::new() };
        assert!(write_png8(&folder.path().join("a.png"), &none).is_err());
        let text = write_png8(&folder.path().join("x/a.png"), &picture()).unwrap_err().to_string();
        assert!(text.contains("x/a.png"), "{text}");
    }
}
