//! Checks DWA-compressed blocks of an OpenEXR file before anything is allocated. Each block states its unpacked sizes, and the decoder
//! would trust them.

use super::linear_picture::FileProblem;
use exr::block::chunk::CompressedBlock;
use exr::compression::Compression;
use exr::meta::BlockDescription;
use exr::meta::header::Header;
use std::io::{BufRead, Seek, SeekFrom};

/// Number of counters at the start of a packed block (`internal_dwa.c` of OpenEXR): version, sizes and counts, and kind of compression.
const COUNTERS: usize = 11;
/// Index of each counter that states an unpacked size, and bytes per unit of it.
const UNPACKED: [(usize, u64); 5] = [(1, 1), (6, 1), (7, 1), (8, 2), (9, 2)];

/// Refuses a file with a block that claims to unpack to more than its pixels can hold. Restores the position of the reader.
pub(super) fn check(reader: &mut (impl BufRead + Seek)) -> Result<(), FileProblem> {
    let said = |error: exr::error::Error| FileProblem::file(error.to_string());
    let start = reader.stream_position().map_err(|error| FileProblem::file(error.to_string()))?;
    let file = exr::block::read(&mut *reader, false).map_err(said)?;
    let headers = file.headers().to_vec();
    let is_packed = |header: &Header| matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_));
    if headers.iter().any(is_packed) {
        for chunk in file.filter_chunks(false, |_, _, block| is_packed(&headers[block.layer])).map_err(said)? {
            let chunk = chunk.map_err(said)?;
            let header = &headers[chunk.layer_index];
            let packed = match &chunk.compressed_block {
                CompressedBlock::ScanLine(block) => &block.compressed_pixels_le,
                CompressedBlock::Tile(block) => &block.compressed_pixels_le,
                _ => continue,
            };
            if promised(packed) > room(header) {
                return Err(FileProblem::file("one of its blocks claims to unpack to more than its pixels can hold")
                    .hint("is the file complete? Write it again with another compression"));
            }
        }
    } else {
        drop(file);
    }
    reader.seek(SeekFrom::Start(start)).map(drop).map_err(|error| FileProblem::file(error.to_string()))
}

/// Largest unpacked size that a block claims, bytes.
fn promised(packed: &[u8]) -> u64 {
    let (numbers, _) = packed.as_chunks::<8>();
    let Some(numbers) = numbers.get(..COUNTERS) else { return 0 };
    UNPACKED.iter().map(|(at, size)| u64::from_le_bytes(numbers[*at]).saturating_mul(*size)).max().unwrap_or(0)
}

/// Upper limit for the size of a sound block, bytes: twice its pixels in whole squares of 8 x 8, plus 4 KiB. The factor two leaves room for
/// run-length markers.
fn room(header: &Header) -> u64 {
    let (width, height) = match header.blocks {
        BlockDescription::ScanLines => (header.layer_size.width(), header.compression.scan_lines_per_block()),
        BlockDescription::Tiles(tiles) => (tiles.tile_size.width(), tiles.tile_size.height()),
    };
    let squares = |side: usize| (side as u64).div_ceil(8).saturating_mul(8);
    let bytes: u64 = header.channels.list.iter().map(|c| c.sample_type.bytes_per_sample() as u64).sum();
    squares(width).saturating_mul(squares(height)).saturating_mul(bytes).saturating_mul(2).saturating_add(4096)
}
