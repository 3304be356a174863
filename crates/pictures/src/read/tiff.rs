//! Reads TIFF without a second copy of the picture: unpacks strips and tiles one by one, or directly to where they belong.

mod size_check;
mod widened;

use super::linear_picture::FileProblem;
use image::error::{DecodingError, LimitError, LimitErrorKind, UnsupportedError, UnsupportedErrorKind};
use image::{ExtendedColorType, ImageDecoder, ImageError, ImageFormat};
use spectra_core::resources::FoundFile;
use std::io::{BufRead, Seek};
use tiff::TiffError;
use tiff::decoder::{ChunkType, Decoder, Limits};
use tiff::tags::{ByteOrder, Tag};
pub(super) use widened::Widened;

/// A file whose samples need no conversion, interleaved or with a plane for each channel.
pub(super) struct Plain<R: BufRead + Seek> {
    decoder: Decoder<R>,
    size: [usize; 2],
    /// Number of planes; 1 if the samples of a pixel are stored together.
    planes: usize,
}

impl<R: BufRead + Seek> Plain<R> {
    /// Opens the file of `decoder` again; `None` if it is of any other kind. `spare_bytes` is the memory that unpacking may take.
    pub(super) fn new(
        reader: R,
        decoder: &impl ImageDecoder,
        format: ImageFormat,
        spare_bytes: u64,
    ) -> Result<Option<Self>, ImageError> {
        if format != ImageFormat::Tiff || decoder.original_color_type() != ExtendedColorType::from(decoder.color_type())
        {
            return Ok(None);
        }
        let mut limits = Limits::default();
        limits.intermediate_buffer_size = usize::try_from(spare_bytes).unwrap_or(usize::MAX);
        limits.ifd_value_size = limits.intermediate_buffer_size;
        let mut own = Decoder::new(reader).map_err(said)?.with_limits(limits);
        let layout = own.find_tag_unsigned::<u16>(Tag::PlanarConfiguration).map_err(said)?;
        let planes = match layout {
            None | Some(1) => 1,
            Some(2) => usize::from(decoder.color_type().channel_count()),
            Some(_) => return Ok(None),
        };
        // Size of one plane.
        let layout_bytes = own.image_buffer_layout().map_err(said)?.len as u64;
        let (width, height) = decoder.dimensions();
        let size = [width as usize, height as usize];
        let is_plain = layout_bytes.checked_mul(planes as u64) == Some(decoder.total_bytes());
        Ok(is_plain.then_some(Self { decoder: own, size, planes }))
    }

    pub(super) fn is_planar(&self) -> bool {
        self.planes > 1
    }

    /// Reads all samples, row by row and pixel by pixel, with `pixel` bytes per pixel. Of a planar file, reads as many planes as `pixel`
    /// has room for at `sample` bytes each.
    pub(super) fn read(&mut self, to: &mut [u8], pixel: usize, sample: usize) -> Result<(), ImageError> {
        if !self.is_planar() {
            return self.decoder.read_image_bytes(to).map_err(said);
        }
        for plane in 0..self.planes.min(pixel / sample) {
            self.runs(plane, sample, |first, samples| {
                let pixels = to[first * pixel..].chunks_exact_mut(pixel);
                for (to, of) in pixels.zip(samples.chunks_exact(sample)) {
                    to[plane * sample..][..sample].copy_from_slice(of);
                }
            })?;
        }
        Ok(())
    }

    /// Calls `take` with runs of pixels of a plane, each of `size` bytes, and with the index in the picture of the first pixel of the run.
    pub(super) fn runs(
        &mut self,
        plane: usize,
        size: usize,
        mut take: impl FnMut(usize, &[u8]),
    ) -> Result<(), ImageError> {
        let decoder = &mut self.decoder;
        let count = match decoder.get_chunk_type() {
            ChunkType::Strip => decoder.strip_count(),
            ChunkType::Tile => decoder.tile_count(),
        };
        let count = count.map_err(said)? as usize / self.planes;
        let [width, height] = self.size;
        let (chunk_width, chunk_height) = decoder.chunk_dimensions();
        let across = width.div_ceil(chunk_width as usize);
        let mut chunk = Vec::new();
        for index in 0..count {
            let stored = (plane * count + index) as u32;
            let (own_width, own_height) = decoder.chunk_data_dimensions(stored);
            let row_bytes = own_width as usize * size;
            chunk.resize(row_bytes * own_height as usize, 0);
            decoder.read_chunk_bytes(stored, &mut chunk).map_err(said)?;
            let (x, y) = (index % across * chunk_width as usize, index / across * chunk_height as usize);
            // The bottom tiles of all planes except the first come with rows below the picture.
            for (row, pixels) in chunk.chunks_exact(row_bytes).take(height - y).enumerate() {
                take((y + row) * width + x, pixels);
            }
        }
        Ok(())
    }
}

/// Returns whether samples are 32-bit integers. The crate `image` passes them on as if they were floating point.
pub(super) fn has_long_integers(reader: impl BufRead + Seek) -> bool {
    const UNSIGNED: u16 = 1;
    let Ok(mut decoder) = Decoder::new(reader) else { return false };
    let mut all = |tag, usual: u16, wanted: u16| {
        let found = decoder.find_tag_unsigned_vec::<u16>(tag).ok().flatten().unwrap_or_else(|| vec![usual]);
        found.iter().all(|value| *value == wanted)
    };
    all(Tag::BitsPerSample, 1, 32) && all(Tag::SampleFormat, UNSIGNED, UNSIGNED)
}

/// Returns whether color is multiplied by alpha, if the file states it (TIFF 6.0, ExtraSamples).
pub(super) fn is_multiplied(reader: impl BufRead + Seek) -> Option<bool> {
    const ASSOCIATED: u16 = 1;
    const UNASSOCIATED: u16 = 2;
    let extra = Decoder::new(reader).ok()?.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples).ok().flatten()?;
    match extra.first() {
        Some(&ASSOCIATED) => Some(true),
        Some(&UNASSOCIATED) => Some(false),
        _ => None,
    }
}

/// Returns the file with the first picture that is no preview moved to the front. `None` if that picture is already the first
/// one. Scanners and converters write a small preview first.
///
/// # Errors
/// The file holds only a preview, as camera raw files do, whose picture is stored elsewhere; or one of its pictures exceeds the size
/// limits.
pub(super) fn without_preview(found: &FoundFile) -> Result<Option<FoundFile>, FileProblem> {
    const REDUCED: u32 = 1;
    let open = || found.open().map_err(|error| FileProblem::file(error.to_string()));
    let text = "it holds a preview only: the pictures in raw files of cameras cannot be read";
    let raw =
        || FileProblem::file(text).hint("develop it in a raw converter and save it as 16-bit TIFF or linear OpenEXR");
    // Canon's raw files begin with a preview that is not marked as one.
    if found.read(12).is_ok_and(|begin| begin.get(8..10) == Some(b"CR")) {
        return Err(raw());
    }
    size_check::check(open()?)?;
    // Other faults of the file are reported when it is read.
    let Ok(mut decoder) = Decoder::new(open()?) else { return Ok(None) };
    let is_preview = |decoder: &mut Decoder<_>| {
        let kind = decoder.find_tag_unsigned::<u32>(Tag::NewSubfileType);
        kind.ok().flatten().is_some_and(|kind| kind & REDUCED != 0)
    };
    if !is_preview(&mut decoder) {
        return Ok(None);
    }
    while decoder.more_images() && decoder.next_image().is_ok() {
        if !is_preview(&mut decoder)
            && let Some(at) = decoder.ifd_pointer()
        {
            let order = decoder.byte_order();
            let mut bytes = found.read(u64::MAX).map_err(|error| FileProblem::file(error.to_string()))?;
            set_first(&mut bytes, at.0, order);
            return Ok(Some(FoundFile::bytes(found.name.clone(), bytes.into())));
        }
    }
    Err(raw())
}

/// Writes the offset of the first picture's directory into the header of a file.
fn set_first(bytes: &mut [u8], at: u64, order: ByteOrder) {
    let at = match order {
        ByteOrder::LittleEndian => at.to_le_bytes(),
        ByteOrder::BigEndian => at.to_be_bytes(),
    };
    // BigTIFF, for files of more than 4 GB, has eight bytes for the offset, after four more.
    let is_big = bytes[2..4].contains(&0x2b);
    match (is_big, order) {
        (true, _) => bytes[8..16].copy_from_slice(&at),
        (false, ByteOrder::LittleEndian) => bytes[4..8].copy_from_slice(&at[..4]),
        (false, ByteOrder::BigEndian) => bytes[4..8].copy_from_slice(&at[4..]),
    }
}

/// Reads the color profile of a file. The decoder of the crate `image` would limit it to the size of the picture.
pub(super) fn profile(reader: impl BufRead + Seek) -> Option<Vec<u8>> {
    let mut limits = Limits::default();
    // The decoder counts 32 bytes per byte, so this allows profiles of 2 MiB.
    limits.decoding_buffer_size = 64 << 20;
    Decoder::new(reader).ok()?.with_limits(limits).get_tag_u8_vec(Tag::IccProfile).ok()
}

/// Returns whether the picture holds four inks.
pub(super) fn has_inks(reader: impl BufRead + Seek) -> bool {
    Decoder::new(reader).is_ok_and(|mut decoder| matches!(decoder.colortype(), Ok(tiff::ColorType::CMYK(_))))
}

/// Converts an error to that of the crate `image`.
pub(super) fn said(error: TiffError) -> ImageError {
    let format = ImageFormat::Tiff;
    match error {
        TiffError::IoError(error) => ImageError::IoError(error),
        TiffError::UnsupportedError(what) => {
            let kind = UnsupportedErrorKind::GenericFeature(what.to_string());
            ImageError::Unsupported(UnsupportedError::from_format_and_kind(format.into(), kind))
        }
        TiffError::LimitsExceeded => ImageError::Limits(LimitError::from_kind(LimitErrorKind::InsufficientMemory)),
        other => ImageError::Decoding(DecodingError::new(format.into(), other)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::decode::decode_bytes;
    use crate::read::header;
    use crate::read::linear_picture::{LinearPicture, ReadOptions};
    use spectra_color::{Transfer, to_u8};
    use std::io::Cursor;
    use tiff::encoder::{TiffEncoder, TiffKind, colortype};

    fn read(bytes: &[u8]) -> LinearPicture {
        decode_bytes(bytes, ReadOptions::default()).expect("a picture")
    }

    /// Writes a picture of this side and these samples, marked as a preview or not.
    fn add<K: TiffKind, C: colortype::ColorType>(
        encoder: &mut TiffEncoder<&mut Cursor<Vec<u8>>, K>,
        side: u32,
        is_preview: bool,
        samples: &[C::Inner],
    ) where
        [C::Inner]: tiff::encoder::TiffValue,
    {
        let mut picture = encoder.new_image::<C>(side, side).expect("written");
        picture.encoder().write_tag(Tag::NewSubfileType, u32::from(is_preview)).expect("written");
        picture.write_data(samples).expect("written");
    }

    const CODES: [u8; 12] = [200, 60, 40, 0, 255, 128, 9, 9, 9, 77, 88, 99];

    #[test]
    fn integers_of_32_bits_are_codes() {
        let mut bytes = Cursor::new(Vec::new());
        let codes = CODES.map(|code| u32::from(code) * 0x0101_0101);
        add::<_, colortype::RGB32>(&mut TiffEncoder::new(&mut bytes).expect("begun"), 2, false, &codes);
        // Most programs leave the tag out, because its default means integers.
        let said = bytes.get_ref().clone();
        let bytes = bytes.get_mut();
        let at = bytes.windows(4).position(|tag| tag == [0x53, 0x01, 0x03, 0x00]).expect("the tag SampleFormat");
        bytes[at..at + 2].copy_from_slice(&0xfde8_u16.to_le_bytes());
        let linear = read(bytes);
        for (light, code) in linear.rgb.iter().flatten().zip(CODES) {
            let wanted = Transfer::Srgb.decode(f64::from(code) / 255.0);
            assert!((f64::from(*light) - wanted).abs() < 1e-6, "{light} {code}");
        }
        assert_eq!(read(&said), linear);
        assert!(linear.clipped_at.is_some() && linear.warnings.is_empty());
    }

    #[test]
    fn large_files_are_tiff() {
        let mut bytes = Cursor::new(Vec::new());
        add::<_, colortype::RGB8>(&mut TiffEncoder::new_big(&mut bytes).expect("begun"), 2, false, &CODES);
        let codes: Vec<u8> =
            read(bytes.get_ref()).rgb.iter().flatten().map(|v| to_u8(Transfer::Srgb.encode(f64::from(*v)))).collect();
        assert_eq!(codes, CODES);
    }

    /// Reads the picture behind a preview, in TIFF and BigTIFF; refuses a file with a preview only.
    #[test]
    fn previews_are_passed_over() {
        let preview = [7_u8; 3];
        let plain = |encoder: &mut TiffEncoder<&mut Cursor<Vec<u8>>, _>| {
            add::<_, colortype::RGB8>(encoder, 1, true, &preview);
            add::<_, colortype::RGB8>(encoder, 2, false, &CODES);
        };
        let (mut small, mut large) = (Cursor::new(Vec::new()), Cursor::new(Vec::new()));
        plain(&mut TiffEncoder::new(&mut small).expect("begun"));
        let mut encoder = TiffEncoder::new_big(&mut large).expect("begun");
        add::<_, colortype::RGB8>(&mut encoder, 1, true, &preview);
        add::<_, colortype::RGB8>(&mut encoder, 2, false, &CODES);
        for bytes in [small, large] {
            let found = FoundFile::bytes("scan.tif".to_owned(), bytes.get_ref().clone().into());
            let header = header(&found, ReadOptions::default()).expect("a picture");
            let linear = read(bytes.get_ref());
            assert_eq!((header.width, linear.width, linear.height), (2, 2, 2));
            assert!((f64::from(linear.rgb[0][0]) - Transfer::Srgb.decode(200.0 / 255.0)).abs() < 1e-6);
        }
        let mut only = Cursor::new(Vec::new());
        add::<_, colortype::RGB8>(&mut TiffEncoder::new(&mut only).expect("begun"), 1, true, &preview);
        let trouble = decode_bytes(only.get_ref(), ReadOptions::default()).expect_err("a preview");
        assert!(trouble.text.contains("preview only") && trouble.hint.is_some());
    }

    /// Builds a file of one strip and one row by hand. `bits` and `format` describe a sample; `extra` is the kind of the extra sample.
    fn by_hand(width: u32, samples: u16, [bits, format]: [u16; 2], extra: Option<u16>, data: &[u8]) -> Vec<u8> {
        let mut tags: Vec<(u16, u16, u32)> = vec![
            (256, 4, width),
            (257, 4, 1),
            (259, 3, 1),
            (262, 3, if samples < 3 { 1 } else { 2 }),
            (273, 4, 0),
            (277, 3, u32::from(samples)),
            (278, 4, 1),
            (279, 4, data.len() as u32),
            // With one channel, planar and interleaved are the same.
            (284, 3, if samples == 1 { 2 } else { 1 }),
        ];
        tags.extend(extra.map(|kind| (338, 3, u32::from(kind))));
        let entries = tags.len() + 2;
        // The directory begins at 8; lists with one value per sample follow it, and then the data.
        let lists = 8 + 2 + 12 * entries + 4;
        let list_bytes = 2 * usize::from(samples);
        let start = lists + 2 * list_bytes;
        let mut all: Vec<(u16, u16, u32, u32)> =
            tags.iter().map(|(tag, kind, value)| (*tag, *kind, 1, *value)).collect();
        for (tag, value, at) in [(258, bits, lists), (339, format, lists + list_bytes)] {
            let one_or_two = if samples == 1 { u32::from(value) } else { u32::from(value) * 0x1_0001 };
            all.push((tag, 3, u32::from(samples), if samples < 3 { one_or_two } else { at as u32 }));
        }
        all.sort_unstable();
        let mut bytes = b"II\x2a\0\x08\0\0\0".to_vec();
        bytes.extend((entries as u16).to_le_bytes());
        for (tag, kind, count, value) in all {
            let value = if tag == 273 { start as u32 } else { value };
            bytes.extend([tag.to_le_bytes(), kind.to_le_bytes()].concat());
            bytes.extend([count.to_le_bytes(), value.to_le_bytes()].concat());
        }
        bytes.extend([0; 4]);
        for value in [bits, format] {
            (0..samples).for_each(|_| bytes.extend(value.to_le_bytes()));
        }
        bytes.extend(data);
        bytes
    }

    /// Gray, half-precision and 64-bit floating point give the same light as 32-bit floating point with three channels.
    #[test]
    fn floating_point_of_all_kinds_is_light() {
        let light = [0.25_f32, 1.5, -0.125];
        let bytes_of = |v: f32, bits: u16| match bits {
            16 => exr::prelude::f16::from_f32(v).to_le_bytes().to_vec(),
            32 => v.to_le_bytes().to_vec(),
            _ => f64::from(v).to_le_bytes().to_vec(),
        };
        for bits in [16, 32, 64] {
            let data: Vec<u8> = light.iter().flat_map(|v| bytes_of(*v, bits)).collect();
            let gray = read(&by_hand(3, 1, [bits, 3], None, &data));
            assert_eq!(gray.rgb, light.map(|v| [v; 3]), "{bits} bits of gray");
            let color = read(&by_hand(1, 3, [bits, 3], None, &data));
            assert_eq!(color.rgb, [light], "{bits} bits");
            assert!(color.clipped_at.is_none());
        }
        let codes = [0_u32, u32::MAX, 1 << 31].iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
        let gray = read(&by_hand(3, 1, [32, 1], None, &codes));
        assert!(
            gray.rgb[0] == [0.0; 3] && gray.rgb[1] == [1.0; 3] && (gray.rgb[2][0] - 0.214).abs() < 1e-3,
            "{gray:?}"
        );
    }

    /// Associated alpha is multiplied into codes, unassociated is not, for all sample types.
    #[test]
    fn alpha_is_what_the_file_says() {
        const ASSOCIATED: u16 = 1;
        const UNASSOCIATED: u16 = 2;
        let of_half = |linear: f64| 0.5 * linear as f32;
        // Code 100 of 255 under alpha 128 of 255 stands for 199.2.
        let straight = of_half(Transfer::Srgb.decode(100.0 / 255.0));
        let multiplied = of_half(Transfer::Srgb.decode(100.0 / 128.0));
        for (extra, want) in [(ASSOCIATED, multiplied), (UNASSOCIATED, straight)] {
            let eight = read(&by_hand(1, 4, [8, 1], Some(extra), &[100, 100, 100, 128]));
            let sixteen: Vec<u8> = [25_700_u16, 25_700, 25_700, 32_896].iter().flat_map(|v| v.to_le_bytes()).collect();
            let sixteen = read(&by_hand(1, 4, [16, 1], Some(extra), &sixteen));
            for linear in [eight, sixteen] {
                assert!((linear.rgb[0][0] - want).abs() < 2e-3, "{extra}: {} {want}", linear.rgb[0][0]);
            }
        }
        for (extra, want) in [(ASSOCIATED, 0.4), (UNASSOCIATED, 0.2)] {
            let data: Vec<u8> = [0.4_f32, 0.4, 0.4, 0.5].iter().flat_map(|v| v.to_le_bytes()).collect();
            let linear = read(&by_hand(1, 4, [32, 3], Some(extra), &data));
            assert!((linear.rgb[0][0] - want).abs() < 1e-6, "{extra}: {}", linear.rgb[0][0]);
        }
    }
}
