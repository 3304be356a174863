//! The frame in tiles, and their numbers.

use spectra_core::frame::FrameSize;

/// Side of a tile, the pixels of a unit of work: blocks that noise is judged by consist of whole ones.
pub(crate) const TILE: u32 = 8;
/// Tiles a side of a patch, whose tiles have numbers in a row: neighbors see much of the same scene, so who takes some of them one after
/// the other finds it in the cache.
const PATCH: u32 = 4;

/// The tiles of a frame, by numbers from 0: patch by patch, within each row by row; smaller at the frame's right and lower border.
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

    /// The tile of a number.
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

    /// The number of the tile that is so many tiles from the left and from the top.
    pub fn number(&self, column: u32, row: u32) -> u32 {
        let (patch, patch_row) = (column / PATCH, row / PATCH);
        let rows = PATCH.min(self.down - patch_row * PATCH);
        let columns = PATCH.min(self.across - patch * PATCH);
        PATCH * (patch_row * self.across + patch * rows) + row % PATCH * columns + column % PATCH
    }

    /// The number of the tile that a pixel of the frame lies in.
    pub fn number_of(&self, pixel: usize) -> u32 {
        let width = self.size.width_px as usize;
        self.number((pixel % width) as u32 / TILE, (pixel / width) as u32 / TILE)
    }

    /// For each pixel of the frame the value of its tile.
    pub fn spread(&self, of_tile: &[f64]) -> Vec<f64> {
        let (side, width) = (TILE as usize, self.size.width_px as usize);
        let row = |row: u32| {
            let tiles = (0..self.across).map(move |column| of_tile[self.number(column, row / TILE) as usize]);
            tiles.flat_map(|value| std::iter::repeat_n(value, side)).take(width)
        };
        (0..self.size.height_px).flat_map(row).collect()
    }
}

/// A square of pixels.
pub(crate) struct Tile {
    /// Of the frame.
    pub width: u32,
    /// Of its first pixel.
    column: u32,
    row: u32,
    columns: u32,
    rows: u32,
}

impl Tile {
    pub fn len(&self) -> u32 {
        self.columns * self.rows
    }

    /// The pixel of the frame that is the tile's `at`.
    pub fn pixel(&self, at: u32) -> u32 {
        (self.row + at / self.columns) * self.width + self.column + at % self.columns
    }

    /// Which of the tile's a pixel of the frame is.
    pub fn at(&self, pixel: u32) -> u32 {
        (pixel / self.width - self.row) * self.columns + pixel % self.width - self.column
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each pixel of frames of all kinds of sides is in one tile, in one place of it.
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
                    assert_eq!((tile.at(pixel), tiles.number_of(pixel as usize)), (at, number));
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
