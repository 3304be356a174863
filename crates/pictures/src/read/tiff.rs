//! TIFF without a second copy of the picture: its strips and tiles are unpacked one by one, or to where they belong.

use image::error::{DecodingError, LimitError, LimitErrorKind, UnsupportedError, UnsupportedErrorKind};
use image::{ExtendedColorType, ImageDecoder, ImageError, ImageFormat};
use std::io::{BufRead, Seek};
use tiff::TiffError;
use tiff::decoder::{ChunkType, Decoder, Limits};
use tiff::tags::Tag;

/// A file whose samples lie as they are wanted: pixel by pixel, and of a kind that needs no conversion.
pub(super) struct Plain<R: BufRead + Seek>(Decoder<R>);

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
        let layout_bytes = own.image_buffer_layout().map_err(said)?.len as u64;
        let is_plain = layout.is_none_or(|layout| layout == 1) && layout_bytes == decoder.total_bytes();
        Ok(is_plain.then_some(Self(own)))
    }

    /// All samples, row by row.
    pub(super) fn read(mut self, to: &mut [u8]) -> Result<(), ImageError> {
        self.0.read_image_bytes(to).map_err(said)
    }

    /// Calls back with runs of pixels of `size` bytes, each with the place of its first one in the picture.
    pub(super) fn runs(
        mut self,
        width: usize,
        size: usize,
        mut take: impl FnMut(usize, &[u8]),
    ) -> Result<(), ImageError> {
        let count = match self.0.get_chunk_type() {
            ChunkType::Strip => self.0.strip_count(),
            ChunkType::Tile => self.0.tile_count(),
        };
        let (chunk_width, chunk_height) = self.0.chunk_dimensions();
        let across = width.div_ceil(chunk_width as usize);
        let mut chunk = Vec::new();
        for index in 0..count.map_err(said)? {
            let (own_width, own_height) = self.0.chunk_data_dimensions(index);
            let row_bytes = own_width as usize * size;
            chunk.resize(row_bytes * own_height as usize, 0);
            self.0.read_chunk_bytes(index, &mut chunk).map_err(said)?;
            let (x, y) =
                (index as usize % across * chunk_width as usize, index as usize / across * chunk_height as usize);
            for (row, pixels) in chunk.chunks_exact(row_bytes).enumerate() {
                take((y + row) * width + x, pixels);
            }
        }
        Ok(())
    }
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
