//! Reads TIFF with samples that the crate `image` does not support: gray floating point, half and double precision, and integers of 32 bits
//! that are marked as such. Passes on red, green and blue of 32 bits for each pixel.

use super::said;
use image::metadata::Orientation;
use image::{ColorType, ExtendedColorType, ImageDecoder, ImageError, ImageResult};
use std::io::{BufRead, Seek};
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

const UNSIGNED: u16 = 1;
const FLOAT: u16 = 3;

/// A decoder that widens the samples of such a TIFF file to 32 bits.
pub(in crate::read) struct Widened<R: BufRead + Seek> {
    decoder: Decoder<R>,
    size: (u32, u32),
    /// Samples per pixel: 1, 3 or 4.
    samples: usize,
}

impl<R: BufRead + Seek> Widened<R> {
    /// Opens the decoder; `None` if the file is of another kind or not sound. In the last case the default decoder of the format
    /// reports what is wrong.
    pub(in crate::read) fn new(reader: R) -> Option<Self> {
        let mut decoder = Decoder::new(reader).ok()?;
        let formats = decoder.find_tag_unsigned_vec::<u16>(Tag::SampleFormat).ok()?.unwrap_or_else(|| vec![UNSIGNED]);
        let format = *formats.first()?;
        let (samples, bits) = match decoder.colortype().ok()? {
            tiff::ColorType::Gray(bits) => (1, bits),
            tiff::ColorType::RGB(bits) => (3, bits),
            tiff::ColorType::RGBA(bits) => (4, bits),
            _ => return None,
        };
        let is_known = match (format, bits) {
            (UNSIGNED, 32) | (FLOAT, 16 | 64) => true,
            (FLOAT, 32) => samples == 1,
            _ => false,
        };
        let is_one = formats.iter().all(|other| *other == format);
        let layout = decoder.find_tag_unsigned::<u16>(Tag::PlanarConfiguration).ok()?.unwrap_or(1);
        let size = decoder.dimensions().ok()?;
        (is_known && is_one && (layout == 1 || samples == 1)).then_some(Self { decoder, size, samples })
    }
}

impl<R: BufRead + Seek> ImageDecoder for Widened<R> {
    fn dimensions(&self) -> (u32, u32) {
        self.size
    }

    fn color_type(&self) -> ColorType {
        if self.samples == 4 { ColorType::Rgba32F } else { ColorType::Rgb32F }
    }

    /// Returns another type if gray samples are repeated, to show that the stored pixels differ from the returned ones.
    fn original_color_type(&self) -> ExtendedColorType {
        if self.samples == 1 { ExtendedColorType::L8 } else { self.color_type().into() }
    }

    fn orientation(&mut self) -> ImageResult<Orientation> {
        let stated = self.decoder.find_tag_unsigned::<u8>(Tag::Orientation).map_err(said)?;
        Ok(stated.and_then(Orientation::from_exif).unwrap_or(Orientation::NoTransforms))
    }

    fn set_limits(&mut self, limits: image::Limits) -> ImageResult<()> {
        limits.check_dimensions(self.size.0, self.size.1)?;
        Ok(())
    }

    fn read_image(self, to: &mut [u8]) -> ImageResult<()> {
        // The samples are in memory in addition to the result.
        const MOST_BYTES: usize = 1 << 31;
        let mut limits = Limits::default();
        // A sample has at most eight bytes; the size of the picture was checked against that of its file.
        limits.decoding_buffer_size =
            (self.size.0 as usize * self.size.1 as usize).saturating_mul(self.samples * 8).min(MOST_BYTES);
        limits.intermediate_buffer_size = limits.decoding_buffer_size.max(1 << 20);
        let mut decoder = self.decoder.with_limits(limits);
        let pixel = 4 * if self.samples == 4 { 4 } else { 3 };
        let mut spread = |values: &mut dyn Iterator<Item = [u8; 4]>| {
            for to in to.chunks_exact_mut(pixel) {
                if self.samples == 1 {
                    let Some(value) = values.next() else { return };
                    to.as_chunks_mut::<4>().0.fill(value);
                } else {
                    to.as_chunks_mut::<4>().0.iter_mut().zip(&mut *values).for_each(|(to, value)| *to = value);
                }
            }
        };
        match decoder.read_image().map_err(said)? {
            DecodingResult::F16(all) => spread(&mut all.iter().map(|v| v.to_f32().to_ne_bytes())),
            DecodingResult::F32(all) => spread(&mut all.iter().map(|v| v.to_ne_bytes())),
            DecodingResult::F64(all) => spread(&mut all.iter().map(|v| (*v as f32).to_ne_bytes())),
            DecodingResult::U32(all) => spread(&mut all.iter().map(|v| v.to_ne_bytes())),
            _ => {
                let kind = image::error::UnsupportedErrorKind::GenericFeature("samples of different types".to_owned());
                let format = image::ImageFormat::Tiff.into();
                return Err(ImageError::Unsupported(image::error::UnsupportedError::from_format_and_kind(
                    format, kind,
                )));
            }
        }
        Ok(())
    }

    fn read_image_boxed(self: Box<Self>, to: &mut [u8]) -> ImageResult<()> {
        (*self).read_image(to)
    }
}
