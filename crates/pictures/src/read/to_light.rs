//! Converts decoded pixels to linear light.
//!
//! Code values are read into the end of the buffer that the light will fill, and expanded from there. A picture thus takes 12 bytes per
//! pixel and no more (and 4 for alpha, if wanted). A picture stored on its side is turned in the same buffer: its code values if there is
//! room in front of them, otherwise its light.

use super::encoding::Encoding;
use super::linear_picture::{LinearPicture, NotRead, OPAQUE, ReadOptions, finite, mend, over_black, positive};
use super::tags::Tags;
use super::{orientation, tiff};
use image::{ColorType, ImageDecoder, ImageError};
use rayon::prelude::*;
use spectra_color::Transfer;
use spectra_color::matrix::{Matrix, apply};
use std::io::{BufRead, Seek};

/// Number of pixels that a thread converts at a time.
const PIXELS_A_TASK: usize = 1 << 14;

/// Bytes of the light of a pixel.
const LIGHT: usize = size_of::<[f32; 3]>();

/// Converts the picture of a decoder to linear light, upright.
pub(super) fn linear<R: BufRead + Seek>(
    decoder: impl ImageDecoder,
    plain: Option<tiff::Plain<R>>,
    orientation: u8,
    choice: ReadOptions<'_>,
    tags: &Tags,
) -> Result<LinearPicture, NotRead> {
    let ReadOptions { alpha: is_alpha_wanted, is_plain, .. } = choice;
    let format = PixelFormat::new(decoder.color_type(), tags, is_plain)?;
    let (width, height) = decoder.dimensions();
    let stored_size = [width as usize, height as usize];
    let pixels = stored_size[0] * stored_size[1];
    let alpha = if format.has_alpha() && is_alpha_wanted { vec![0.0_f32; pixels] } else { Vec::new() };
    let mut buffer = LightBuffer { format: &format, rgb: vec![[0.0; 3]; pixels], alpha, thin: 0 };
    let mut is_upright = orientation == 1;
    if format.size <= LIGHT {
        buffer.read_codes(decoder, plain)?;
        is_upright = is_upright || buffer.turn_codes(stored_size, orientation);
        buffer.expand();
    } else if let Some(plain) = plain {
        buffer.fill_by_runs(plain)?;
    } else {
        let mut codes = vec![0; pixels * format.size];
        decoder.read_image(&mut codes)?;
        codes.chunks_exact(format.size).enumerate().for_each(|(i, pixel)| buffer.set(i, pixel));
    }
    let LightBuffer { mut rgb, mut alpha, thin, .. } = buffer;
    let mut warnings = Vec::new();
    if format.is_float() && !is_plain {
        warnings.extend(mend(&mut rgb));
        rgb.iter_mut().flatten().for_each(|value| *value = finite(*value));
    }
    if !is_alpha_wanted && !is_plain {
        warnings.extend(over_black(thin, pixels));
    }
    if !is_upright {
        orientation::upright(&mut rgb, stored_size, orientation);
        orientation::upright(alpha.as_chunks_mut::<1>().0, stored_size, orientation);
    }
    let turned = orientation::is_on_its_side(orientation);
    Ok(LinearPicture {
        width: if turned { height } else { width },
        height: if turned { width } else { height },
        pixel_aspect: orientation::seen_aspect(tags.pixel_aspect, turned),
        rgb,
        alpha: (!alpha.is_empty()).then_some(alpha),
        depth: None,
        clipped_at: format.clipped_at(),
        warnings,
    })
}

/// Sample types of a decoded pixel.
#[derive(Clone, Copy)]
enum Samples {
    Bytes,
    Shorts,
    /// 32-bit integers, which a TIFF may have.
    Longs,
    Floats,
}

/// Form of the decoded pixels of a file, and how they turn into light.
struct PixelFormat<'a> {
    samples: Samples,
    /// Bytes per pixel.
    size: usize,
    /// Channels per pixel, with alpha.
    count: usize,
    /// Encoding that the file or the user states.
    stated: Option<&'a Encoding>,
    /// Encoding of integers: the stated one, or else sRGB.
    of_integers: Encoding,
    /// Light of each code of 8 or 16 bits.
    table: Vec<f32>,
    to_srgb: Option<Matrix>,
    /// Whether the codes of colors are multiplied by alpha.
    is_multiplied: bool,
    /// Whether light is multiplied by alpha already, or must not be.
    is_light_multiplied: bool,
}

impl<'a> PixelFormat<'a> {
    /// Chooses the conversion by the color type and the tags of a file. Plain values are not light and stay as they are.
    fn new(color: ColorType, tags: &'a Tags, is_plain: bool) -> Result<Self, NotRead> {
        let samples = match color {
            ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => Samples::Bytes,
            ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => Samples::Shorts,
            ColorType::Rgb32F | ColorType::Rgba32F if tags.is_long => Samples::Longs,
            ColorType::Rgb32F | ColorType::Rgba32F => Samples::Floats,
            other => return Err(NotRead::Unsupported(format!("pixels of type {other:?} cannot be read"))),
        };
        let stated = tags.encoding.as_ref();
        let of_integers = stated.cloned().unwrap_or(Encoding::Curve(Transfer::Srgb));
        let table = match samples {
            Samples::Bytes => of_integers.table(256),
            Samples::Shorts => of_integers.table(65_536),
            Samples::Longs | Samples::Floats => Vec::new(),
        };
        let is_float = matches!(samples, Samples::Floats);
        Ok(Self {
            samples,
            size: usize::from(color.bytes_per_pixel()),
            count: usize::from(color.channel_count()),
            stated,
            of_integers,
            table,
            to_srgb: tags.to_srgb.filter(|_| color.has_color() && !is_plain),
            // Integers are not multiplied by alpha, and floating point is, unless the file says otherwise.
            is_multiplied: tags.is_multiplied.unwrap_or(false) && !is_plain,
            is_light_multiplied: is_plain || (is_float && tags.is_multiplied.unwrap_or(true)),
        })
    }

    fn has_alpha(&self) -> bool {
        self.count.is_multiple_of(2)
    }

    fn is_float(&self) -> bool {
        matches!(self.samples, Samples::Floats)
    }

    /// Returns the light at which integers clip. Primaries of another space map white to white except for the last digits.
    fn clipped_at(&self) -> Option<f32> {
        let nearly = if self.to_srgb.is_some() { 1.0 - 1e-5 } else { 1.0 };
        (!self.is_float()).then(|| self.of_integers.clipped_at() * nearly)
    }

    /// Returns the light of a pixel and its alpha.
    fn light(&self, pixel: &[u8]) -> ([f32; 3], f32) {
        let Self { samples, count, is_multiplied, .. } = *self;
        let short = |c: usize| u16::from_ne_bytes([pixel[2 * c], pixel[2 * c + 1]]);
        let four = |c: usize| [pixel[4 * c], pixel[4 * c + 1], pixel[4 * c + 2], pixel[4 * c + 3]];
        let float = |c: usize| f32::from_ne_bytes(four(c));
        let long = |c: usize| f64::from(u32::from_ne_bytes(four(c))) / f64::from(u32::MAX);
        let gray = count < 3;
        let alpha = match samples {
            _ if !self.has_alpha() => 1.0,
            Samples::Bytes => f32::from(pixel[count - 1]) / 255.0,
            Samples::Shorts => f32::from(short(count - 1)) / 65_535.0,
            Samples::Longs => long(count - 1) as f32,
            Samples::Floats => positive(float(count - 1)).min(1.0),
        };
        let rgb = [0, 1, 2].map(|c| {
            let c = if gray { 0 } else { c };
            // A multiplied code is the code of the covering color times alpha.
            let uncovered = |code: f64| self.of_integers.light((code / f64::from(alpha)).min(1.0));
            match samples {
                Samples::Bytes if is_multiplied && alpha > 0.0 => uncovered(f64::from(pixel[c]) / 255.0),
                Samples::Shorts if is_multiplied && alpha > 0.0 => uncovered(f64::from(short(c)) / 65_535.0),
                Samples::Longs if is_multiplied && alpha > 0.0 => uncovered(long(c)),
                Samples::Bytes => self.table[usize::from(pixel[c])],
                Samples::Shorts => self.table[usize::from(short(c))],
                Samples::Longs => self.of_integers.light(long(c)),
                Samples::Floats => self.stated.map_or(float(c), |encoding| encoding.light(f64::from(float(c)))),
            }
        });
        let rgb = self.to_srgb.map_or(rgb, |matrix| {
            let converted = apply(&matrix, rgb.map(f64::from)).map(|v| v as f32);
            if self.is_float() { converted } else { converted.map(finite) }
        });
        if !self.has_alpha() || self.is_light_multiplied {
            return (rgb, alpha);
        }
        (rgb.map(|v| v * alpha), alpha)
    }
}

/// Light of a picture while it is filled, pixel by pixel.
struct LightBuffer<'a> {
    format: &'a PixelFormat<'a>,
    rgb: Vec<[f32; 3]>,
    /// Alpha of each pixel; empty if it is not wanted.
    alpha: Vec<f32>,
    /// Number of pixels that are not opaque.
    thin: usize,
}

impl LightBuffer<'_> {
    /// Sets pixel `i` from its code values.
    fn set(&mut self, i: usize, codes: &[u8]) {
        let (light, alpha) = self.format.light(codes);
        self.thin += usize::from(alpha < OPAQUE);
        self.rgb[i] = light;
        if let Some(at) = self.alpha.get_mut(i) {
            *at = alpha;
        }
    }

    /// Returns where the code values start in the buffer if they lie at its end.
    fn start(&self) -> usize {
        self.rgb.len() * (LIGHT - self.format.size)
    }

    /// Reads the code values into the end of the buffer.
    fn read_codes<R: BufRead + Seek>(
        &mut self,
        decoder: impl ImageDecoder,
        plain: Option<tiff::Plain<R>>,
    ) -> Result<(), ImageError> {
        let (start, PixelFormat { size, count, .. }) = (self.start(), self.format);
        let memory: &mut [u8] = bytemuck::cast_slice_mut(&mut self.rgb);
        match plain {
            Some(mut plain) => plain.read(&mut memory[start..], *size, size / count),
            None => decoder.read_image(&mut memory[start..]),
        }
    }

    /// Turns the code values upright if there is room in front of them, and returns whether there was.
    fn turn_codes(&mut self, stored_size: [usize; 2], orientation: u8) -> bool {
        let (start, size) = (self.start(), self.format.size);
        if 2 * size > LIGHT {
            return false;
        }
        let memory: &mut [u8] = bytemuck::cast_slice_mut(&mut self.rgb);
        let (before, codes) = memory.split_at_mut(start);
        let room = start - codes.len();
        for (i, pixel) in before[room..].chunks_exact_mut(size).enumerate() {
            pixel.copy_from_slice(&codes[orientation::stored(i, stored_size, orientation) * size..][..size]);
        }
        memory.copy_within(room..start, start);
        true
    }

    /// Expands the code values at the end of the buffer to light.
    fn expand(&mut self) {
        let (start, format, pixels) = (self.start(), self.format, self.rgb.len());
        let size = format.size;
        let mut done = 0;
        // Light in front of the codes that are still to come does not overwrite them. Each pass converts as many pixels as fit there: three
        // quarters, then three quarters of the rest, and so on.
        while self.alpha.is_empty() && size < LIGHT {
            let memory: &mut [u8] = bytemuck::cast_slice_mut(&mut self.rgb);
            let (free, codes) = memory.split_at_mut(start + done * size);
            let clear = (free.len() / LIGHT - done).min(pixels - done);
            if clear < PIXELS_A_TASK {
                break;
            }
            let to = free[done * LIGHT..][..clear * LIGHT].par_chunks_mut(PIXELS_A_TASK * LIGHT);
            let thin = to.zip(codes.par_chunks(PIXELS_A_TASK * size)).map(|(to, codes)| {
                let mut thin = 0;
                for (to, pixel) in to.chunks_exact_mut(LIGHT).zip(codes.chunks_exact(size)) {
                    let (light, alpha) = format.light(pixel);
                    thin += usize::from(alpha < OPAQUE);
                    to.copy_from_slice(bytemuck::bytes_of(&light));
                }
                thin
            });
            self.thin += thin.sum::<usize>();
            done += clear;
        }
        let mut pixel = [0_u8; LIGHT];
        for i in done..pixels {
            let memory: &[u8] = bytemuck::cast_slice(&self.rgb);
            pixel[..size].copy_from_slice(&memory[start + i * size..][..size]);
            self.set(i, &pixel[..size]);
        }
    }

    /// Fills the buffer from a file whose pixels take more bytes than their light.
    fn fill_by_runs<R: BufRead + Seek>(&mut self, mut plain: tiff::Plain<R>) -> Result<(), ImageError> {
        let PixelFormat { size, count, .. } = *self.format;
        if !plain.is_planar() {
            return plain.runs(0, size, |first, codes| {
                codes.chunks_exact(size).enumerate().for_each(|(i, pixel)| self.set(first + i, pixel));
            });
        }
        // Colors go first to where the light will be; a pixel is complete when its alpha arrives.
        plain.read(bytemuck::cast_slice_mut(&mut self.rgb), LIGHT, size / count)?;
        let mut pixel = vec![0_u8; size];
        plain.runs(count - 1, size - LIGHT, |first, codes| {
            for (i, alpha) in codes.chunks_exact(size - LIGHT).enumerate() {
                pixel[..LIGHT].copy_from_slice(bytemuck::bytes_of(&self.rgb[first + i]));
                pixel[LIGHT..].copy_from_slice(alpha);
                self.set(first + i, &pixel);
            }
        })
    }
}
