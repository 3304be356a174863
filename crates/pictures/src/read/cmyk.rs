//! Reads JPEG and TIFF files of printing inks (CMYK) that have a color profile. Passes them on as 16-bit integers in [`space`], whose
//! primaries enclose what inks print, with the curve of sRGB.

use super::ink_profile::InkProfile;
use super::linear_picture::FileProblem;
use super::{jpeg, tiff};
use image::error::{DecodingError, UnsupportedError, UnsupportedErrorKind};
use image::metadata::Orientation;
use image::{ColorType, ExtendedColorType, ImageDecoder, ImageError, ImageFormat, ImageResult};
use rayon::prelude::*;
use spectra_color::{RgbSpace, Transfer};
use spectra_core::resources::FoundFile;
use std::io::{BufRead, Seek};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Number of inks per pixel.
const INKS: usize = 4;
/// Number of pixels that a thread converts at a time.
const PIXELS_A_TASK: usize = 1 << 14;

/// Original color type that marks the decoder of a CMYK file; no other decoder has it.
pub(super) const KIND: ExtendedColorType = ExtendedColorType::Unknown(48);

/// The color space in which CMYK files are passed on.
pub(super) fn space() -> &'static RgbSpace {
    RgbSpace::rec2020()
}

/// A decoder of a CMYK file with a color profile.
pub(super) struct Cmyk<R: BufRead + Seek> {
    codes: Codes<R>,
    inks: InkProfile,
    size: (u32, u32),
    orientation: Orientation,
}

/// The source of amounts of ink.
enum Codes<R: BufRead + Seek> {
    /// Bytes of the file, and whether it holds CMYK or YCCK.
    Jpeg(Vec<u8>, ColorSpace),
    Tiff(Box<::tiff::decoder::Decoder<R>>),
}

/// Returns whether a file holds four inks.
pub(super) fn is_one(found: &FoundFile, format: ImageFormat) -> bool {
    match format {
        ImageFormat::Jpeg => found.open().ok().and_then(jpeg::components) == Some(INKS as u8),
        ImageFormat::Tiff => found.open().ok().is_some_and(tiff::has_inks),
        _ => false,
    }
}

/// Returns the warning about a CMYK file without a profile.
pub(super) fn without_profile() -> FileProblem {
    let text = "it holds printing inks (CMYK) without a color profile that says what they look like: its colors are computed by plain \
                arithmetic, and are purer and brighter than in print";
    FileProblem::file(text).hint("save it with its profile, or as sRGB")
}

impl<R: BufRead + Seek> Cmyk<R> {
    /// Opens a CMYK decoder; `None` if the file is of another kind, has no profile of inks, or is not sound. In the last case the
    /// default decoder of the format reports what is wrong.
    pub(super) fn new(mut reader: R, found: &FoundFile, format: ImageFormat) -> Option<Self> {
        if !is_one(found, format) {
            return None;
        }
        match format {
            ImageFormat::Jpeg => {
                let mut bytes = Vec::new();
                reader.read_to_end(&mut bytes).ok()?;
                let mut decoder = JpegDecoder::new_with_options(ZCursor::new(&bytes[..]), options());
                decoder.decode_headers().ok()?;
                let (width, height) = decoder.dimensions()?;
                let space = decoder.input_colorspace().filter(|s| matches!(s, ColorSpace::CMYK | ColorSpace::YCCK))?;
                let inks = InkProfile::read(&decoder.icc_profile()?, self::space())?;
                let orientation = decoder.exif().and_then(|exif| Orientation::from_exif_chunk(exif));
                let size = (u32::try_from(width).ok()?, u32::try_from(height).ok()?);
                let orientation = orientation.unwrap_or(Orientation::NoTransforms);
                Some(Self { codes: Codes::Jpeg(bytes, space), inks, size, orientation })
            }
            _ => {
                let inks = InkProfile::read(&tiff::profile(found.open().ok()?)?, self::space())?;
                let mut decoder = ::tiff::decoder::Decoder::new(reader).ok()?;
                let stated = decoder.find_tag_unsigned::<u8>(::tiff::tags::Tag::Orientation).ok()?;
                let orientation = stated.and_then(Orientation::from_exif).unwrap_or(Orientation::NoTransforms);
                let size = decoder.dimensions().ok()?;
                Some(Self { codes: Codes::Tiff(Box::new(decoder)), inks, size, orientation })
            }
        }
    }
}

/// Writes pixels from amounts of ink, each from 0 to 1.
fn print(inks: &InkProfile, to: &mut [u8], amounts: impl Fn(usize) -> [f64; INKS] + Sync) {
    const PIXEL: usize = 6;
    to.par_chunks_mut(PIXELS_A_TASK * PIXEL).enumerate().for_each(|(task, to)| {
        let mut known = None;
        for (i, to) in to.chunks_exact_mut(PIXEL).enumerate() {
            let own = amounts(task * PIXELS_A_TASK + i);
            let code = match known {
                Some((before, code)) if before == own => code,
                _ => inks.light(own).map(|light| {
                    let code = Transfer::Srgb.encode(light.clamp(0.0, 1.0));
                    ((code * 65_535.0).round() as u16).to_ne_bytes()
                }),
            };
            known = Some((own, code));
            to.copy_from_slice(code.as_flattened());
        }
    });
}

fn options() -> DecoderOptions {
    DecoderOptions::default().set_strict_mode(false).set_max_width(usize::MAX).set_max_height(usize::MAX)
}

/// Converts the bytes of a JPEG pixel to amounts of ink. Adobe's programs, and others after them, store them inverted: 255 is no ink.
/// The first three bytes of YCCK encode R, G and B of the inks as if they were light (JFIF).
fn inks_of_jpeg([a, b, c, k]: [u8; INKS], space: ColorSpace) -> [f64; INKS] {
    let [a, b, c, k] = [a, b, c, k].map(f64::from);
    let stored = if space == ColorSpace::YCCK {
        let (cb, cr) = (b - 128.0, c - 128.0);
        let rgb = [a + 1.402 * cr, a - 0.344_136 * cb - 0.714_136 * cr, a + 1.772 * cb];
        let [r, g, b] = rgb.map(|v| 255.0 - v.round().clamp(0.0, 255.0));
        [r, g, b, k]
    } else {
        [a, b, c, k]
    };
    stored.map(|v| 1.0 - v / 255.0)
}

impl<R: BufRead + Seek> ImageDecoder for Cmyk<R> {
    fn dimensions(&self) -> (u32, u32) {
        self.size
    }

    fn color_type(&self) -> ColorType {
        ColorType::Rgb16
    }

    fn original_color_type(&self) -> ExtendedColorType {
        KIND
    }

    fn orientation(&mut self) -> ImageResult<Orientation> {
        Ok(self.orientation)
    }

    fn set_limits(&mut self, limits: image::Limits) -> ImageResult<()> {
        limits.check_dimensions(self.size.0, self.size.1)?;
        Ok(())
    }

    fn read_image(mut self, to: &mut [u8]) -> ImageResult<()> {
        let codes = std::mem::replace(&mut self.codes, Codes::Jpeg(Vec::new(), ColorSpace::CMYK));
        let pixels = self.size.0 as usize * self.size.1 as usize;
        match codes {
            Codes::Jpeg(bytes, space) => {
                let wrong = |text: String| ImageError::Decoding(DecodingError::new(ImageFormat::Jpeg.into(), text));
                let mut decoder =
                    JpegDecoder::new_with_options(ZCursor::new(&bytes[..]), options().jpeg_set_out_colorspace(space));
                let codes = decoder.decode().map_err(|error| wrong(error.to_string()))?;
                let codes = codes.as_chunks::<INKS>().0;
                if codes.len() != pixels {
                    return Err(wrong("the number of pixels differs from that in the header".to_owned()));
                }
                print(&self.inks, to, |i| inks_of_jpeg(codes[i], space));
            }
            Codes::Tiff(decoder) => {
                let mut limits = ::tiff::decoder::Limits::default();
                limits.decoding_buffer_size = pixels.saturating_mul(2 * INKS);
                limits.intermediate_buffer_size = limits.decoding_buffer_size.max(1 << 20);
                let unsupported = |text: &str| {
                    let kind = UnsupportedErrorKind::GenericFeature(text.to_owned());
                    let format = ImageFormat::Tiff.into();
                    ImageError::Unsupported(UnsupportedError::from_format_and_kind(format, kind))
                };
                match decoder.with_limits(limits).read_image().map_err(tiff::said)? {
                    ::tiff::decoder::DecodingResult::U8(all) if all.len() == pixels * INKS => {
                        let all = all.as_chunks::<INKS>().0;
                        print(&self.inks, to, |i| all[i].map(|v| f64::from(v) / 255.0));
                    }
                    ::tiff::decoder::DecodingResult::U16(all) if all.len() == pixels * INKS => {
                        let all = all.as_chunks::<INKS>().0;
                        print(&self.inks, to, |i| all[i].map(|v| f64::from(v) / 65_535.0));
                    }
                    _ => {
                        return Err(unsupported(
                            "printing inks (CMYK) stored in planes, or with other than 8 or 16 bits",
                        ));
                    }
                }
            }
        }
        Ok(())
    }

    fn read_image_boxed(self: Box<Self>, to: &mut [u8]) -> ImageResult<()> {
        (*self).read_image(to)
    }
}

#[cfg(test)]
mod tests {
    use crate::read::decode::decode_bytes;
    use crate::read::linear_picture::ReadOptions;
    use spectra_color::Transfer;
    use spectra_core::resources::FoundFile;

    /// Compares twelve patches of ink, with a profile of each kind of table, and as JPEG in CMYK and YCCK, with LittleCMS 2 on the same
    /// files (`xtask/picture_samples.py`).
    /// They agree within one code value, or 2 in the JPEG whose inks are rounded twice.
    #[test]
    fn inks_look_as_their_profile_says() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/inks/");
        let listed = std::fs::read_to_string(format!("{folder}lcms2.csv")).expect("the reference");
        let mut files: Vec<(String, Vec<[f64; 3]>)> = Vec::new();
        for row in listed.lines().skip(1) {
            let fields: Vec<&str> = row.split(',').collect();
            let rgb = [2, 3, 4].map(|k| fields[k].parse::<f64>().expect("a number"));
            match files.last_mut().filter(|(name, _)| name == fields[0]) {
                Some((_, patches)) => patches.push(rgb),
                None => files.push((fields[0].to_owned(), vec![rgb])),
            }
        }
        assert_eq!(files.len(), 5);
        for (name, patches) in files {
            let bytes = std::fs::read(format!("{folder}{name}")).expect("a sample");
            let read = decode_bytes(&bytes, ReadOptions::default()).expect("a picture");
            assert!(read.warnings.is_empty() && (read.width, read.height) == (32, 24), "{name}: {:?}", read.warnings);
            let most = if name == "ycck.jpg" { 2.01 } else { 1.01 };
            for (i, want) in patches.iter().enumerate() {
                let light = read.rgb[(8 * (i / 4) + 4) * 32 + 8 * (i % 4) + 4];
                for c in 0..3 {
                    let got = 255.0 * Transfer::Srgb.encode(f64::from(light[c]).clamp(0.0, 1.0));
                    assert!((got - want[c]).abs() < most, "{name}, patch {i}: {got} for {} in {c}", want[c]);
                }
            }
        }
    }

    #[test]
    fn inks_without_a_profile_are_told() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/inks/");
        let bytes = std::fs::read(format!("{folder}cmyk.jpg")).expect("a sample");
        // The profile gets another marker, which no reader knows.
        let at = bytes.windows(12).position(|w| w == b"ICC_PROFILE\0").expect("a profile");
        let mut without = bytes.clone();
        without[at - 3] = 0xec;
        let found = FoundFile::bytes("print.jpg".to_owned(), without.into());
        let read = crate::read::header(&found, ReadOptions::default()).expect("a picture");
        assert!(read.warnings.iter().any(|doubt| doubt.text.contains("CMYK")), "{:?}", read.warnings);
        // A profile with a broken byte anywhere does not crash the reader.
        for at in (at..at + 4000).step_by(7) {
            let mut bad = bytes.clone();
            bad[at] ^= 0xff;
            let _ = decode_bytes(&bad, ReadOptions::default());
        }
    }
}
