//! Narrows lines through a height field to the part of each that has to be walked, many lines in parallel.

use spectra_core::math::floor_index;

/// Number of lines that are processed in parallel.
pub(super) const SIDE_BY_SIDE: usize = 64;

/// Loops over some of the lines are rounded up to a multiple of this number, so that all vectors are full.
const VECTOR: usize = 8;

/// One number for each line.
pub(super) type Each = [f64; SIDE_BY_SIDE];

/// A further look at the bounds is worthwhile if the last one left less than this fraction of the line.
pub(super) const MUCH_SHORTER: f64 = 0.8;

/// A line in picture coordinates: column and row (pixels from the upper left) at w = 0, and their change per w, where w is one over the
/// depth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub at_infinity: [f64; 2],
    pub per_w: [f64; 2],
}

impl Line {
    #[inline(always)]
    pub(super) fn at(&self, w: f64) -> [f64; 2] {
        let ([a, b], [x, y]) = (self.at_infinity, self.per_w);
        [a + x * w, b + y * w]
    }
}

/// Lines stored in columns, for parallel processing. Entries beyond the last line are arbitrary.
pub(super) struct Lines {
    pub at_infinity: [Each; 2],
    pub per_w: [Each; 2],
}

impl Lines {
    pub(super) fn new() -> Self {
        Self { at_infinity: [[0.0; SIDE_BY_SIDE]; 2], per_w: [[0.0; SIDE_BY_SIDE]; 2] }
    }

    #[inline(always)]
    pub(super) fn line(&self, i: usize) -> Line {
        Line {
            at_infinity: [self.at_infinity[0][i], self.at_infinity[1][i]],
            per_w: [self.per_w[0][i], self.per_w[1][i]],
        }
    }
}

/// Lines that are being narrowed. Finished lines are removed, and the others move up.
pub(super) struct Narrowing {
    pub(super) len: usize,
    /// Index of each line in [`Lines`].
    pub(super) ray: [u32; SIDE_BY_SIDE],
    pub(super) at_infinity: [Each; 2],
    pub(super) per_w: [Each; 2],
    pub(super) room: [Each; 2],
    pub(super) near: Each,
    pub(super) far: Each,
    /// Fraction of the remaining line that the next look covers.
    pub(super) part: Each,
}

/// Bounds of the surfaces around each line, for one step of narrowing.
pub(super) struct Look {
    pub(super) upto: Each,
    /// The box of pixels around the line: first column and row, last column and row.
    pub(super) corners: [[u32; SIDE_BY_SIDE]; 4],
    pub(super) nearest: [f32; SIDE_BY_SIDE],
    pub(super) farthest: [f32; SIDE_BY_SIDE],
    /// Not 0 if the box is as small as the smallest square.
    pub(super) small: [u32; SIDE_BY_SIDE],
    /// Not 0 if the line is finished.
    pub(super) done: [u32; SIDE_BY_SIDE],
}

impl Look {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            upto: [0.0; SIDE_BY_SIDE],
            corners: [[0; SIDE_BY_SIDE]; 4],
            nearest: [0.0; SIDE_BY_SIDE],
            farthest: [0.0; SIDE_BY_SIDE],
            small: [0; SIDE_BY_SIDE],
            done: [0; SIDE_BY_SIDE],
        }
    }

    #[inline(always)]
    pub(super) fn of(&self, i: usize) -> ([usize; 2], [usize; 2]) {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.corners[k][i] as usize);
        ([a, b], [c, d])
    }
}

impl Narrowing {
    #[inline(always)]
    pub(super) fn new() -> Self {
        const ZERO: Each = [0.0; SIDE_BY_SIDE];
        Self {
            len: 0,
            ray: [0; SIDE_BY_SIDE],
            at_infinity: [ZERO; 2],
            per_w: [ZERO; 2],
            room: [ZERO; 2],
            near: ZERO,
            far: ZERO,
            part: ZERO,
        }
    }

    #[inline(always)]
    pub(super) fn line(&self, i: usize) -> Line {
        Line {
            at_infinity: [self.at_infinity[0][i], self.at_infinity[1][i]],
            per_w: [self.per_w[0][i], self.per_w[1][i]],
        }
    }

    /// Appends a line if `is_wanted`.
    #[inline(always)]
    pub(super) fn take(&mut self, lines: &Lines, i: usize, is_wanted: bool) {
        let at = self.len % SIDE_BY_SIDE;
        self.ray[at] = i as u32;
        for k in 0..2 {
            self.at_infinity[k][at] = lines.at_infinity[k][i];
            self.per_w[k][at] = lines.per_w[k][i];
        }
        self.len += usize::from(is_wanted);
    }

    /// Computes the boxes of pixels under the parts of the lines to look at: see [`super::height_field::HeightField::around_line`].
    #[inline(always)]
    pub(super) fn boxes(&self, last: [f64; 2], look: &mut Look) {
        for i in 0..self.len.next_multiple_of(VECTOR).min(SIDE_BY_SIDE) {
            let (near, far, line) = (self.near[i], self.far[i], self.line(i));
            let upto = if self.part[i] == 1.0 { far } else { near - self.part[i] * (near - far) };
            let [a, b] = [line.at(near), line.at(upto)];
            for k in 0..2 {
                look.corners[k][i] = pixel(less(a[k], b[k]) - self.room[k][i], last[k]);
                look.corners[2 + k][i] = pixel(more(a[k], b[k]) + self.room[k][i], last[k]);
            }
            look.upto[i] = upto;
        }
    }

    /// Moves the ends of the lines according to the bounds found.
    #[inline(always)]
    pub(super) fn shorten(&mut self, look: &mut Look) {
        for i in 0..self.len.next_multiple_of(VECTOR).min(SIDE_BY_SIDE) {
            let (nearest, farthest) = (f64::from(look.nearest[i]), f64::from(look.farthest[i]));
            let (near, far, upto, part) = (self.near[i], self.far[i], look.upto[i], self.part[i]);
            let next = less(near, more(nearest, upto));
            let end = if (farthest > far) & (farthest >= upto) { less(farthest, next) } else { far };
            let shorter = next - end < MUCH_SHORTER * (near - far);
            let moved = next < near;
            self.part[i] = if shorter & moved {
                1.0
            } else if shorter | moved {
                part
            } else {
                0.5 * part
            };
            self.near[i] = next;
            self.far[i] = end;
            look.done[i] = u32::from((next == end) | (!shorter & (look.small[i] != 0)));
        }
    }

    /// Writes the current near end of all lines, and removes the finished ones.
    #[inline(always)]
    pub(super) fn keep(&mut self, look: &Look, found: &mut Each) {
        let mut kept = 0;
        for i in 0..self.len {
            let ray = self.ray[i];
            found[ray as usize % SIDE_BY_SIDE] = self.near[i];
            let to = kept % SIDE_BY_SIDE;
            self.ray[to] = ray;
            for k in 0..2 {
                self.at_infinity[k][to] = self.at_infinity[k][i];
                self.per_w[k][to] = self.per_w[k][i];
                self.room[k][to] = self.room[k][i];
            }
            self.near[to] = self.near[i];
            self.far[to] = self.far[i];
            self.part[to] = self.part[i];
            kept += usize::from(look.done[i] == 0);
        }
        self.len = kept;
    }
}

/// Returns the pixel that contains a position along a side, or the nearest one.
#[inline(always)]
pub(super) fn pixel(at: f64, last: f64) -> u32 {
    floor_index(at, last).0
}

/// Returns the smaller of two numbers, or the second one if one is NaN.
#[inline(always)]
pub(super) fn less(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Returns the larger of two numbers, or the second one if one is NaN.
#[inline(always)]
pub(super) fn more(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
