//! Depth bounds: the nearest and the farthest surface in squares of many sizes. What a ray meets lies between them.
//!
//! A ray is a straight chord over the picture (see [`super::height_field`]). The bounds in the square around the chord limit where the ray can
//! meet a surface. That shortens the chord, and a smaller square then has tighter bounds. Over a plane, a wall or a slope, two or three
//! lookups leave a pixel or two to walk through.

/// The largest and the smallest inverse depth, 1/mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ends {
    pub nearest: f32,
    pub farthest: f32,
}

impl Ends {
    fn and(self, other: Self) -> Self {
        Self { nearest: self.nearest.max(other.nearest), farthest: self.farthest.min(other.farthest) }
    }
}

/// Bounds of squares of all sizes. Squares of one size start at steps of a quarter of their size, so that a box of at most four steps per
/// side lies within one.
pub(super) struct Bounds {
    /// Bounds for steps of 2, 4, 8, ... pixels, one size after the other, row by row.
    squares: Vec<Ends>,
    /// Start of each size in `squares`, and the number of squares per row.
    levels: Vec<[usize; 2]>,
}

/// Smallest step in pixels, as an exponent of two.
const FIRST_STEP: u32 = 1;
/// Largest length of a box, in steps, that a square always contains, wherever the box starts.
const STEPS: usize = 4;

impl Bounds {
    /// Creates the bounds from the inverse depth of the pixels, 1/mm.
    pub(super) fn new(width: usize, height: usize, inverse_mm: &[f32]) -> Self {
        let of = |w: &f32| Ends { nearest: *w, farthest: *w };
        // Cells of one step per side, without their surroundings.
        let mut cells: Vec<Ends> = inverse_mm.iter().map(of).collect();
        let (mut across, mut down) = (width, height);
        let (mut all, mut levels) = (Vec::new(), Vec::new());
        for _ in 0..FIRST_STEP {
            (cells, across, down) = halved(&cells, across, down);
        }
        loop {
            levels.push([all.len(), across]);
            all.extend(squares(&cells, across, down));
            if across <= STEPS + 1 && down <= STEPS + 1 {
                break;
            }
            (cells, across, down) = halved(&cells, across, down);
        }
        Self { squares: all, levels }
    }

    /// Returns the bounds in a box of pixels, from its first to its last column and row, and a little beyond it.
    #[inline(always)]
    pub(super) fn of(&self, first: [usize; 2], last: [usize; 2]) -> Ends {
        // The smallest step of which four cover the box.
        let steps = long(first, last).div_ceil(STEPS);
        let power = (usize::BITS - (steps.max(1) - 1).leading_zeros()).max(FIRST_STEP);
        let at = ((power - FIRST_STEP) as usize).min(self.levels.len() - 1);
        let [begin, across] = self.levels[at];
        let shift = at as u32 + FIRST_STEP;
        self.squares[begin + (first[1] >> shift) * across + (first[0] >> shift)]
    }

    /// Returns whether a box is as small as the smallest square, so that there are no tighter bounds.
    #[inline(always)]
    pub(super) fn is_small(first: [usize; 2], last: [usize; 2]) -> bool {
        long(first, last) <= STEPS << (FIRST_STEP - 1)
    }
}

/// Returns the longer side of a box, without its first pixel.
#[inline(always)]
fn long(first: [usize; 2], last: [usize; 2]) -> usize {
    (last[0] - first[0]).max(last[1] - first[1])
}

/// Merges cells into cells of twice the side.
fn halved(cells: &[Ends], across: usize, down: usize) -> (Vec<Ends>, usize, usize) {
    let (wide, high) = (across.div_ceil(2), down.div_ceil(2));
    let mut all = Vec::with_capacity(wide * high);
    for row in 0..high {
        let rows = [2 * row, (2 * row + 1).min(down - 1)];
        for column in 0..wide {
            let columns = [2 * column, (2 * column + 1).min(across - 1)];
            let at = |r: usize, c: usize| cells[rows[r] * across + columns[c]];
            all.push(at(0, 0).and(at(0, 1)).and(at(1, 0)).and(at(1, 1)));
        }
    }
    (all, wide, high)
}

/// Merges, for each cell, [`STEPS`] + 1 cells to the right and down from it.
fn squares(cells: &[Ends], across: usize, down: usize) -> Vec<Ends> {
    let mut wide = Vec::with_capacity(cells.len());
    for row in cells.chunks_exact(across) {
        for column in 0..across {
            let upto = (column + STEPS + 1).min(across);
            wide.push(row[column..upto].iter().copied().reduce(Ends::and).unwrap_or(row[column]));
        }
    }
    let mut all = Vec::with_capacity(cells.len());
    for row in 0..down {
        for column in 0..across {
            let rows = row..(row + STEPS + 1).min(down);
            let first = wide[row * across + column];
            all.push(rows.map(|r| wide[r * across + column]).fold(first, Ends::and));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_lies_between_the_ends_of_its_square() {
        for (width, height) in [(1, 1), (3, 2), (37, 23), (64, 5), (5, 130)] {
            let depth: Vec<f32> = (0..width * height).map(|i| ((i * 7919) % 613) as f32).collect();
            let bounds = Bounds::new(width, height, &depth);
            for k in 0..4000_usize {
                let (a, b) = (k * 31 % width, k * 57 % width);
                let (c, d) = (k * 13 % height, k * 101 % height);
                let (first, last) = ([a.min(b), c.min(d)], [a.max(b), c.max(d)]);
                let ends = bounds.of(first, last);
                for row in first[1]..=last[1] {
                    for column in first[0]..=last[0] {
                        let w = depth[row * width + column];
                        assert!(ends.farthest <= w && w <= ends.nearest, "{width} {height} {first:?} {last:?}");
                    }
                }
            }
        }
    }

    /// A square extends little beyond the box: at most two steps on each side.
    #[test]
    fn squares_are_close() {
        let (width, height) = (200, 100);
        let columns: Vec<f32> = (0..width * height).map(|i| (i % width) as f32).collect();
        let bounds = Bounds::new(width, height, &columns);
        for long in [0, 1, 3, 8, 9, 20, 60] {
            for first in 0..width - long {
                let ends = bounds.of([first, 7], [first + long, 7]);
                let room = (long as f32).max(8.0);
                assert!(ends.nearest - ends.farthest <= 2.5 * room, "{first} {long} {ends:?}");
            }
        }
    }
}
