//! The tiles of a frame and their numbers.

use spectra_core::frame::FrameSize;

/// Side of a tile (the pixels of a unit of work), pixels. Blocks in which noise is judged consist of whole tiles.
pub(crate) const TILE: u32 = 8;
/// Side of a patch, in tiles. Tiles of a patch have consecutive numbers: neighbors see much of the same scene, so a thread that takes some
/// of them one after the other finds it in the cache.
const PATCH: u32 = 4;

/// The tiles of a frame, numbered from 0 patch by patch and row by row within a patch. Tiles at the right and lower border of the frame may
/// be smaller.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tiles {
    size: FrameSize,
    across: u32,
    down: u32,
}

impl Tiles {
    pub fn of(size: FrameSize) -> Self {
        Self { size, across: size.width_px.div_ceil(TILE), down: size.height_px.div_ceil(TILE) }
    }

    pub fn count(&self) -> usize {
        self.across as usize * self.down as usize
    }

    /// Returns the tile with this number.
    pub fn tile(&self, number: u32) -> Tile {
        let of_row = PATCH * self.across;
        let (patch_row, in_row) = (number / of_row, number % of_row);
        let rows = PATCH.min(self.down - patch_row * PATCH);
        let (patch, in_patch) = (in_row / (PATCH * rows), in_row % (PATCH * rows));
        let columns = PATCH.min(self.across - patch * PATCH);
        let (column, row) = (patch * PATCH + in_patch % columns, patch_row * PATCH + in_patch / columns);
        let (column, row) = (column * TILE, row * TILE);
        let FrameSize { width_px, height_px, .. } = self.size;
        let (columns, rows) = (TILE.min(width_px - column), TILE.min(height_px - row));
        Tile { width: width_px, column, row, columns, rows }
    }

    /// Returns the number of the tile in this column and row of tiles, counted from the left and the top.
    pub fn number(&self, column: u32, row: u32) -> u32 {
        let (patch, patch_row) = (column / PATCH, row / PATCH);
        let rows = PATCH.min(self.down - patch_row * PATCH);
        let columns = PATCH.min(self.across - patch * PATCH);
        PATCH * (patch_row * self.across + patch * rows) + row % PATCH * columns + column % PATCH
    }

    /// Returns the number of the tile that holds a pixel of the frame.
    pub fn number_of(&self, pixel: usize) -> u32 {
        let width = self.size.width_px as usize;
        self.number((pixel % width) as u32 / TILE, (pixel / width) as u32 / TILE)
    }

    /// Returns for each pixel of the frame the value of its tile.
    pub fn spread(&self, of_tile: &[f64]) -> Vec<f64> {
        let (side, width) = (TILE as usize, self.size.width_px as usize);
        let row = |row: u32| {
            let tiles = (0..self.across).map(move |column| of_tile[self.number(column, row / TILE) as usize]);
            tiles.flat_map(|value| std::iter::repeat_n(value, side)).take(width)
        };
        (0..self.size.height_px).flat_map(row).collect()
    }
}

/// A rectangle of pixels of the frame, square except at the border.
pub(crate) struct Tile {
    /// Width of the frame, pixels.
    pub width: u32,
    /// Column of the first pixel of the tile in the frame.
    column: u32,
    row: u32,
    columns: u32,
    rows: u32,
}

impl Tile {
    pub fn len(&self) -> u32 {
        self.columns * self.rows
    }

    /// Returns the frame's number of the pixel at position `at` in the tile.
    pub fn pixel(&self, at: u32) -> u32 {
        (self.row + at / self.columns) * self.width + self.column + at % self.columns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every pixel of frames with various sides is in exactly one tile.
    #[test]
    fn tiles_cover_the_frame_once() {
        for (width_px, height_px) in [(1, 1), (8, 8), (33, 7), (100, 70), (96, 64), (31, 129)] {
            let size = FrameSize { width_px, height_px, width_mm: 36.0, height_mm: 24.0 };
            let tiles = Tiles::of(size);
            let mut seen = vec![0_u32; size.pixels()];
            for number in 0..tiles.count() as u32 {
                let tile = tiles.tile(number);
                for at in 0..tile.len() {
                    let pixel = tile.pixel(at);
                    assert_eq!(tiles.number_of(pixel as usize), number);
                    seen[pixel as usize] += 1;
                }
            }
            assert!(seen.iter().all(|times| *times == 1), "{width_px} x {height_px}");
            let numbers: Vec<f64> = (0..tiles.count()).map(|number| number as f64).collect();
            let spread = tiles.spread(&numbers);
            assert!(spread.iter().enumerate().all(|(pixel, of)| *of == f64::from(tiles.number_of(pixel))));
            assert_eq!(spread.len(), size.pixels());
        }
    }

    #[test]
    fn neighbors_follow_each_other() {
        let tiles = Tiles::of(FrameSize { width_px: 128, height_px: 64, width_mm: 36.0, height_mm: 24.0 });
        for number in 0..16 {
            let tile = tiles.tile(16 + number);
            assert_eq!([tile.column, tile.row], [32 + number % 4 * 8, number / 4 * 8]);
        }
    }
}
