//! The blocks of a frame, in which noise is judged, and the squares that hold them.

use crate::tiles::TILE;
use spectra_core::frame::FrameSize;

/// Side of a block, pixels; it holds whole tiles.
const BLOCK: usize = 16;
const _: () = assert!(BLOCK.is_multiple_of(TILE as usize));
/// Side of a square, blocks: 64 pixels. What is decided about a block depends on no light outside its square.
const SQUARE: usize = 4;

/// The frame, divided into blocks, which are numbered row by row.
pub(crate) struct Blocks {
    pub across: usize,
    pub down: usize,
    width: usize,
    height: usize,
}

impl Blocks {
    pub fn of(size: FrameSize) -> Self {
        let (width, height) = (size.width_px as usize, size.height_px as usize);
        Self { across: width.div_ceil(BLOCK), down: height.div_ceil(BLOCK), width, height }
    }

    pub fn count(&self) -> usize {
        self.across * self.down
    }

    /// Iterates over the pixels of a block, row by row.
    pub fn pixels(&self, block: usize) -> impl Iterator<Item = usize> {
        self.each(block, 1)
    }

    /// Iterates over the first pixel of each tile of a block.
    pub fn tiles(&self, block: usize) -> impl Iterator<Item = usize> {
        self.each(block, TILE as usize)
    }

    /// Iterates over a block and those around it that lie in the same square.
    pub fn around(&self, block: usize) -> impl Iterator<Item = usize> {
        let (column, row, across) = (block % self.across, block / self.across, self.across);
        let near = |at: usize, of: usize| {
            let first = at / SQUARE * SQUARE;
            at.saturating_sub(1).max(first)..(at + 2).min(first + SQUARE).min(of)
        };
        let (columns, rows) = (near(column, across), near(row, self.down));
        rows.flat_map(move |row| columns.clone().map(move |column| row * across + column))
    }

    /// Iterates over the first pixel of each square of this side in a block.
    fn each(&self, block: usize, side: usize) -> impl Iterator<Item = usize> {
        let (column, row) = (block % self.across * BLOCK, block / self.across * BLOCK);
        let columns = (column..self.width.min(column + BLOCK)).step_by(side);
        let (rows, width) = ((row..self.height.min(row + BLOCK)).step_by(side), self.width);
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbors_lie_in_the_same_square() {
        let blocks = Blocks::of(FrameSize { width_px: 100, height_px: 64, width_mm: 36.0, height_mm: 24.0 });
        assert_eq!((blocks.across, blocks.down), (7, 4));
        // In the corner of a square, in its middle, and at the border of the frame.
        assert!(blocks.around(3).eq([2, 3, 9, 10]));
        assert!(blocks.around(8).eq([0, 1, 2, 7, 8, 9, 14, 15, 16]));
        assert!(blocks.around(27).eq([19, 20, 26, 27]));
    }
}
