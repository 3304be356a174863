//! Acceleration grid: finds the shapes that may cover a point.
//!
//! The chart is divided into square cells, 1024 along its longer side (fewer if there would be too many of the lists below),
//! grouped in blocks of 8 x 8. A block or cell of one ink stores that ink. Any other cell lists the shapes that may touch it,
//! top first, down to the ink that covers all of it. Equal lists are stored once. The grid is built by halving a square around
//! the chart again and again; each part tests only the shapes that its parent could not decide.

use std::collections::HashMap;

use super::cell::{Cell, Coverage};
use super::ink::NO_INK;
use super::shape::Shape;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::math::floor_index;

/// Number of halvings from the whole chart to a cell.
const DEPTH: u32 = 10;
/// Number of halvings from a block to a cell.
const BLOCK_DEPTH: u32 = 3;
const BLOCK: usize = 1 << BLOCK_DEPTH;
/// Margin of a cell, as a fraction of its size, when shapes are tested against it. Rounding (some 1e-13 of the chart) may assign a
/// point to a neighboring cell, and must not change its ink.
const MARGIN: f64 = 1e-6;

/// Low bits of a block entry: a mask for the cell number within the block. It is all ones if the block has its own cells, and 0 if
/// one cell represents all of it. The bits above are the index of its first cell. Since the mask is data, the compiler makes
/// no branch of it, which random points would often mispredict.
const CELL_MASK: u32 = (BLOCK * BLOCK - 1) as u32;
const CELL_BITS: u32 = 2 * BLOCK_DEPTH;
/// Bit that is set in the entry of a cell with a list; the other bits are the number of the list.
const HAS_LIST: u16 = 1 << 15;
/// Cell number of a point outside the chart.
const OUTSIDE: u32 = u32::MAX;
/// Number of points that a batch looks up at a time.
const CHUNK: usize = 256;

/// Acceleration grid of a chart.
#[derive(Clone, Debug)]
pub struct Grid {
    /// Number of cells along the longer side.
    along: usize,
    half_width_mm: f64,
    half_height_mm: f64,
    cells_per_mm: f64,
    /// Number of blocks in a row.
    columns: usize,
    /// Last column and last row of cells.
    last: [usize; 2],
    blocks: Vec<u32>,
    /// Entries of cells: first one for each ink, to which blocks of one ink point, then those of the other blocks.
    cells: Vec<u16>,
    /// Start of each list in `listed`.
    lists: Vec<u32>,
    /// All lists. Each consists of the number of shapes, the ink below them, and the shapes from the top.
    listed: Vec<u16>,
}

impl Grid {
    /// Builds the grid of a chart `width_mm` x `height_mm`. Each of `shapes`, later ones on top, has the index of its ink. The
    /// ground has the ink 0.
    #[must_use]
    pub fn new(width_mm: f64, height_mm: f64, shapes: &[(Shape, u16)]) -> Self {
        let mut depth = DEPTH;
        loop {
            let grid = Self::of_depth(width_mm, height_mm, shapes, depth);
            // List number 32767 would be read as no ink. Cells twice as large need fewer lists; one block has 64 at most.
            if grid.lists.len() < usize::from(HAS_LIST) {
                return grid;
            }
            depth -= 1;
        }
    }

    /// Returns the grid for the same chart in another size, since the shapes that may touch a cell stay the same.
    #[must_use]
    pub fn scaled(&self, width_mm: f64, height_mm: f64) -> Self {
        let cell_mm = width_mm.max(height_mm) / self.along as f64;
        let [half_width_mm, half_height_mm] = [0.5 * width_mm, 0.5 * height_mm];
        Self { half_width_mm, half_height_mm, cells_per_mm: 1.0 / cell_mm, ..self.clone() }
    }

    fn of_depth(width_mm: f64, height_mm: f64, shapes: &[(Shape, u16)], depth: u32) -> Self {
        let side_mm = width_mm.max(height_mm);
        let along = 1_usize << depth;
        let cell_mm = side_mm / along as f64;
        let blocks_over =
            |extent_mm: f64| ((extent_mm / cell_mm / BLOCK as f64).ceil() as usize).clamp(1, along / BLOCK);
        let [columns, rows] = [blocks_over(width_mm), blocks_over(height_mm)];
        let inks = shapes.iter().map(|&(_, ink)| ink).max().unwrap_or(0);
        let grid = Self {
            along,
            half_width_mm: 0.5 * width_mm,
            half_height_mm: 0.5 * height_mm,
            cells_per_mm: 1.0 / cell_mm,
            columns,
            last: [columns * BLOCK - 1, rows * BLOCK - 1],
            blocks: vec![0; columns * rows],
            cells: (0..=inks).collect(),
            lists: Vec::new(),
            listed: Vec::new(),
        };
        let mut builder = Builder { grid, shapes, depth, margin_mm: MARGIN * cell_mm, known: HashMap::new() };
        let square =
            Cell { center_mm: [0.5 * (side_mm - width_mm), 0.5 * (side_mm - height_mm)], half_mm: [0.5 * side_mm; 2] };
        let all: Vec<u16> = (0..shapes.len() as u16).rev().collect();
        builder.part(&square, 0, [0, 0], &all, 0);
        builder.grid
    }

    /// Returns the index of the ink at a point of the chart, mm; [`NO_INK`] outside it.
    #[inline]
    #[must_use]
    pub fn ink_at(&self, shapes: &[(Shape, u16)], x_mm: f64, y_mm: f64) -> u16 {
        let entry = self.entry(x_mm, y_mm);
        if entry & HAS_LIST == 0 || entry == NO_INK { entry } else { self.top_of_list(entry, shapes, x_mm, y_mm) }
    }

    /// Computes [`Grid::ink_at`] for many points and writes the indices to `ink`. For each chunk of points, vector code finds the
    /// cells, and one pass without branches looks them up. Points whose cells have a list of shapes are decided afterwards.
    pub fn ink_at_batch(&self, shapes: &[(Shape, u16)], x_mm: &[f64], y_mm: &[f64], ink: &mut [u16], isa: Isa) {
        let chunks = x_mm.chunks(CHUNK).zip(y_mm.chunks(CHUNK)).zip(ink.chunks_mut(CHUNK));
        let (mut block, mut within) = ([0; CHUNK], [0; CHUNK]);
        for ((x_mm, y_mm), ink) in chunks {
            let count = x_mm.len().min(y_mm.len()).min(ink.len());
            let (x_mm, y_mm) = (&x_mm[..count], &y_mm[..count]);
            isa.run(Find { grid: self, x_mm, y_mm, block: &mut block, within: &mut within });
            let mut open = [0_u16; CHUNK];
            let mut opened = 0;
            for i in 0..count {
                let entry = self.entry_at(block[i], within[i]);
                ink[i] = entry;
                open[opened] = i as u16;
                opened += usize::from(entry & HAS_LIST != 0 && entry != NO_INK);
            }
            for &i in &open[..opened] {
                let i = usize::from(i);
                ink[i] = self.top_of_list(ink[i], shapes, x_mm[i], y_mm[i]);
            }
        }
    }

    /// Returns the entry of the cell of a point: an ink, or a list.
    #[inline(always)]
    fn entry(&self, x_mm: f64, y_mm: f64) -> u16 {
        let [block, within] = self.place(x_mm, y_mm);
        self.entry_at(block, within)
    }

    /// Returns the number of the block of a point, and the number of its cell within the block or [`OUTSIDE`].
    #[inline(always)]
    fn place(&self, x_mm: f64, y_mm: f64) -> [u32; 2] {
        const SIDE: u32 = BLOCK as u32;
        let inside = (x_mm.abs() <= self.half_width_mm) & (y_mm.abs() <= self.half_height_mm);
        // A point outside the chart still gets a valid cell of the grid.
        let (column, _) = floor_index((x_mm + self.half_width_mm) * self.cells_per_mm, self.last[0] as f64);
        let (row, _) = floor_index((y_mm + self.half_height_mm) * self.cells_per_mm, self.last[1] as f64);
        let within = row % SIDE * SIDE + column % SIDE;
        [row / SIDE * self.columns as u32 + column / SIDE, if inside { within } else { OUTSIDE }]
    }

    #[inline(always)]
    fn entry_at(&self, block: u32, within: u32) -> u16 {
        let block = self.blocks[block as usize];
        let entry = self.cells[((block >> CELL_BITS) + (within & block & CELL_MASK)) as usize];
        if within == OUTSIDE { NO_INK } else { entry }
    }

    fn top_of_list(&self, entry: u16, shapes: &[(Shape, u16)], x_mm: f64, y_mm: f64) -> u16 {
        let start = self.lists[usize::from(entry & !HAS_LIST)] as usize;
        let count = usize::from(self.listed[start]);
        for &index in &self.listed[start + 2..start + 2 + count] {
            let (shape, ink) = &shapes[usize::from(index)];
            if shape.contains(x_mm, y_mm) {
                return *ink;
            }
        }
        self.listed[start + 1]
    }

    /// Memory used by the grid, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        4 * (self.blocks.len() + self.lists.len()) + 2 * (self.cells.len() + self.listed.len())
    }
}

/// A job that computes [`Grid::place`] for a chunk of points.
struct Find<'a> {
    grid: &'a Grid,
    x_mm: &'a [f64],
    y_mm: &'a [f64],
    block: &'a mut [u32; CHUNK],
    within: &'a mut [u32; CHUNK],
}

impl Vectorized for Find<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let len = self.x_mm.len().min(CHUNK);
        let (x_mm, y_mm) = (&self.x_mm[..len], &self.y_mm[..len]);
        let (block, within) = (&mut self.block[..len], &mut self.within[..len]);
        for i in 0..len {
            [block[i], within[i]] = self.grid.place(x_mm[i], y_mm[i]);
        }
    }
}

struct Builder<'a> {
    grid: Grid,
    shapes: &'a [(Shape, u16)],
    depth: u32,
    margin_mm: f64,
    known: HashMap<Vec<u16>, u16>,
}

impl Builder<'_> {
    /// Decides one part of the chart. `place` is its column and row among parts of this size, `above` are the shapes that may
    /// touch it, top first, and `ink` lies below them.
    fn part(&mut self, cell: &Cell, depth: u32, place: [usize; 2], above: &[u16], ink: u16) {
        let rows = self.grid.blocks.len() / self.grid.columns;
        if depth <= self.depth - BLOCK_DEPTH {
            let blocks = 1 << (self.depth - BLOCK_DEPTH - depth);
            if place[0] * blocks >= self.grid.columns || place[1] * blocks >= rows {
                return;
            }
        }
        let (above, ink) = self.remaining(cell, above, ink);
        if depth < self.depth - BLOCK_DEPTH || (depth < self.depth && !above.is_empty()) {
            if depth == self.depth - BLOCK_DEPTH {
                let first = self.grid.cells.len() as u32;
                self.grid.blocks[place[1] * self.grid.columns + place[0]] = first << CELL_BITS | CELL_MASK;
                self.grid.cells.resize(self.grid.cells.len() + BLOCK * BLOCK, 0);
            }
            for quarter in 0..4 {
                let place = [2 * place[0] + (quarter & 1), 2 * place[1] + (quarter >> 1)];
                self.part(&cell.quarter(quarter), depth + 1, place, &above, ink);
            }
            return;
        }
        let entry = if above.is_empty() { ink } else { HAS_LIST | self.list(&above, ink) };
        self.fill(depth, place, entry);
    }

    /// Returns the shapes of `above` that may cover only some of the part, and the ink below them.
    fn remaining(&self, cell: &Cell, above: &[u16], ink: u16) -> (Vec<u16>, u16) {
        let padded = cell.padded(self.margin_mm);
        let mut rest = Vec::new();
        for &index in above {
            let (shape, own) = &self.shapes[usize::from(index)];
            match shape.coverage(&padded) {
                Coverage::None => {}
                Coverage::Partial => rest.push(index),
                Coverage::Full => return (trimmed(rest, self.shapes, *own), *own),
            }
        }
        (trimmed(rest, self.shapes, ink), ink)
    }

    /// Returns the number of the list, which is added if it is new. The number is wrong if there are more lists than an entry can
    /// name.
    fn list(&mut self, above: &[u16], ink: u16) -> u16 {
        let mut list = vec![above.len() as u16, ink];
        list.extend_from_slice(above);
        let Grid { lists, listed, .. } = &mut self.grid;
        *self.known.entry(list).or_insert_with_key(|list| {
            lists.push(listed.len() as u32);
            listed.extend_from_slice(list);
            (lists.len() - 1) as u16
        })
    }

    /// Writes `entry` to all cells of a part: to the block itself, or to cells of the block that contains the part.
    fn fill(&mut self, depth: u32, place: [usize; 2], entry: u16) {
        if depth == self.depth - BLOCK_DEPTH {
            self.grid.blocks[place[1] * self.grid.columns + place[0]] = u32::from(entry) << CELL_BITS;
            return;
        }
        let side = 1 << (self.depth - depth);
        let [column, row] = [place[0] * side, place[1] * side];
        let block = self.grid.blocks[row / BLOCK * self.grid.columns + column / BLOCK];
        let first = (block >> CELL_BITS) as usize;
        for r in row % BLOCK..row % BLOCK + side {
            let start = first + r * BLOCK + column % BLOCK;
            self.grid.cells[start..start + side].fill(entry);
        }
    }
}

/// Drops the lowest shapes as long as they have the same ink as the ground below them.
fn trimmed(mut above: Vec<u16>, shapes: &[(Shape, u16)], ink: u16) -> Vec<u16> {
    while above.last().is_some_and(|&index| shapes[usize::from(index)].1 == ink) {
        above.pop();
    }
    above
}

#[cfg(test)]
mod tests {
    use super::super::shape::Ring;
    use super::*;

    #[test]
    fn more_shapes_than_lists_have_numbers_make_larger_cells() {
        // 200 x 200 disks, each in cells of its own.
        let disks: Vec<(Shape, u16)> = (0..40_000_u32)
            .map(|i| {
                let center = [f64::from(i % 200) - 99.5, f64::from(i / 200) - 99.5];
                (Ring::disk(center, 0.2).into(), 1 + (i % 3) as u16)
            })
            .collect();
        let grid = Grid::new(200.0, 200.0, &disks);
        assert!(grid.lists.len() < 32_767 && grid.last[0] < 1023, "{} lists", grid.lists.len());
        for i in 0..4000_u32 {
            let [x, y] = [f64::from(i * 37 % 2000) / 10.01 - 99.9, f64::from(i * 91 % 2000) / 10.01 - 99.9];
            let top = disks.iter().rev().find(|(shape, _)| shape.contains(x, y));
            assert_eq!(grid.ink_at(&disks, x, y), top.map_or(0, |d| d.1), "({x}, {y})");
        }
    }

    #[test]
    fn tall_and_flat_sheets_are_covered() {
        for [width, height] in [[3.0, 1000.0], [1000.0, 3.0], [1.0, 1.0]] {
            let shapes: Vec<(Shape, u16)> = vec![(Ring::disk([0.4 * width, -0.4 * height], 0.05).into(), 5)];
            let grid = Grid::new(width, height, &shapes);
            assert_eq!(grid.ink_at(&shapes, 0.4 * width, -0.4 * height), 5);
            assert_eq!(grid.ink_at(&shapes, 0.4 * width, -0.4 * height + 0.06), 0);
            assert_eq!(grid.ink_at(&shapes, 0.5 * width, 0.5 * height), 0);
            assert_eq!(grid.ink_at(&shapes, 0.51 * width, 0.0), NO_INK);
        }
    }
}
