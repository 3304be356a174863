//! TIFF without a second copy of the picture: its strips and tiles are unpacked one by one, or to where they belong.

use image::error::{DecodingError, LimitError, LimitErrorKind, UnsupportedError, UnsupportedErrorKind};
use image::{ExtendedColorType, ImageDecoder, ImageError, ImageFormat};
use std::io::{BufRead, Seek};
use tiff::TiffError;
use tiff::decoder::{ChunkType, Decoder, Limits};
use tiff::tags::Tag;

/// A file whose samples are of a kind that needs no conversion, pixel by pixel or a plane for each channel.
pub(super) struct Plain<R: BufRead + Seek> {
    decoder: Decoder<R>,
    size: [usize; 2],
    /// How many planes there are, one where the samples of a pixel lie together.
    planes: usize,
}

impl<R: BufRead + Seek> Plain<R> {
    /// The file behind `decoder`, read once more; `None` of any other kind. `spare_bytes` is what it may take to unpack.
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
        // Of one plane.
        let layout_bytes = own.image_buffer_layout().map_err(said)?.len as u64;
        let (width, height) = decoder.dimensions();
        let size = [width as usize, height as usize];
        let is_plain = layout_bytes.checked_mul(planes as u64) == Some(decoder.total_bytes());
        Ok(is_plain.then_some(Self { decoder: own, size, planes }))
    }

    pub(super) fn is_planar(&self) -> bool {
        self.planes > 1
    }

    /// All samples, row by row and pixel by pixel, of `pixel` bytes each. Of planes as many as a pixel has room for, of
    /// `sample` bytes each.
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

    /// Calls back with runs of pixels of `size` bytes of a plane, each with the place of its first one in the picture.
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
            // The lowest tiles of a plane but the first are given with the rows below the picture.
            for (row, pixels) in chunk.chunks_exact(row_bytes).take(height - y).enumerate() {
                take((y + row) * width + x, pixels);
            }
        }
        Ok(())
    }
}

/// The color profile of a file. The decoder of the crate `image` has no more room for it than for the picture.
pub(super) fn profile(reader: impl BufRead + Seek) -> Option<Vec<u8>> {
    let mut limits = Limits::default();
    // A byte takes 32 of them: profiles of 2 MiB.
    limits.decoding_buffer_size = 64 << 20;
    Decoder::new(reader).ok()?.with_limits(limits).get_tag_u8_vec(Tag::IccProfile).ok()
}

/// As the crate `image` says it.
fn said(error: TiffError) -> ImageError {
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
