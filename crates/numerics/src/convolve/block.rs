//! Two-dimensional transforms of one block.
//!
//! A block is stored in panels of [`LANES`] columns; within a panel, row follows row. Columns are transformed in place. Rows
//! are transformed [`LANES`] at a time: their squares of the panels are transposed on the way to and from a line.

use super::fft::{Fft, LANES, Lane};
use super::real::Real;
use crate::isa::{Isa, Vectorized};

/// Transforms of blocks of one size.
pub(super) struct Transform<T> {
    across: Fft<T>,
    down: Fft<T>,
}

/// Work buffers for a block: a real and an imaginary part.
pub(super) struct Scratch<T> {
    block: [Vec<Lane<T>>; 2],
    /// Some rows, transposed.
    line: [Vec<Lane<T>>; 2],
    width: usize,
    height: usize,
}

impl<T: Real> Scratch<T> {
    pub(super) fn new(transform: &Transform<T>) -> Self {
        let (width, height) = (transform.width(), transform.height());
        let lanes = |count: usize| vec![[T::default(); LANES]; count];
        let block = || lanes(width.div_ceil(LANES) * height);
        Self { block: [block(), block()], line: [lanes(width), lanes(width)], width, height }
    }

    /// Fills the two parts of the block with the surroundings of the tiles that start at the columns `x0` and the row `y0` of a
    /// plane of size `size`. Values outside the plane, and values that are not finite, become 0.
    #[inline(always)]
    pub(super) fn load(&mut self, plane: &[f32], size: [usize; 2], x0: [usize; 2], y0: usize, radius: usize) {
        for (block, x0) in self.block.iter_mut().zip(x0) {
            // Columns of the block that lie on the plane: column c is x = x0 + c - radius.
            let first = radius.saturating_sub(x0).min(self.width);
            let last = (size[0] + radius).saturating_sub(x0).min(self.width).max(first);
            for row in 0..self.height {
                let y = (y0 + row).checked_sub(radius).filter(|y| *y < size[1]);
                let line = y.map_or(&[][..], |y| &plane[y * size[0]..][..size[0]]);
                for (panel, lanes) in block.chunks_exact_mut(self.height).enumerate() {
                    let (to, column) = (&mut lanes[row], panel * LANES);
                    let of = |from: f32| if from.is_finite() { T::of_single(from) } else { T::default() };
                    if y.is_some() && column >= first && column + LANES <= last {
                        for (to, from) in to.iter_mut().zip(&line[x0 + column - radius..][..LANES]) {
                            *to = of(*from);
                        }
                        continue;
                    }
                    *to = [T::default(); LANES];
                    for c in first.max(column)..last.min(column + LANES) {
                        to[c - column] = line.get(x0 + c - radius).map_or(T::default(), |from| of(*from));
                    }
                }
            }
        }
    }

    /// Copies `line.len()` values of part 0 or 1 of the block, from the row `row` and the column `from` on.
    #[inline(always)]
    pub(super) fn read(&self, part: usize, row: usize, from: usize, line: &mut [T]) {
        let mut done = 0;
        while done < line.len() {
            let (panel, lane) = ((from + done) / LANES, (from + done) % LANES);
            let count = (LANES - lane).min(line.len() - done);
            let lanes = &self.block[part][panel * self.height + row];
            line[done..done + count].copy_from_slice(&lanes[lane..lane + count]);
            done += count;
        }
    }
}

impl<T: Real> Transform<T> {
    /// Creates transforms for blocks of `width` by `height`, powers of two of at least [`LANES`].
    pub(super) fn new(width: usize, height: usize) -> Self {
        assert!(width >= LANES && height >= LANES, "{width} x {height} is less than {LANES} lanes");
        Self { across: Fft::new(width), down: Fft::new(height) }
    }

    pub(super) fn width(&self) -> usize {
        self.across.length()
    }

    pub(super) fn height(&self) -> usize {
        self.down.length()
    }

    /// Returns the spectrum of point-symmetric weights, divided by the number of points, in groups of [`LANES`] rows.
    pub(super) fn spectrum(&self, radius: usize, weight: impl Fn(isize, isize) -> f64, isa: Isa) -> Vec<Lane<T>> {
        let scale = 1.0 / (self.width() * self.height()) as f64;
        self.spectrum_with(radius, weight, &mut Scratch::new(self), scale, isa)
    }

    /// Returns the spectrum of point-symmetric weights times `scale`. Weights as wide as the block wrap around once.
    pub(super) fn spectrum_with(
        &self,
        radius: usize,
        weight: impl Fn(isize, isize) -> f64,
        scratch: &mut Scratch<T>,
        scale: f64,
        isa: Isa,
    ) -> Vec<Lane<T>> {
        let (width, height) = (self.width(), self.height());
        scratch.block.iter_mut().for_each(|part| part.fill([T::default(); LANES]));
        // The signed offset from the origin, around the block.
        let way = |k: usize, length: usize| if 2 * k <= length { k as isize } else { k as isize - length as isize };
        for j in 0..height {
            for i in 0..width {
                let (di, dj) = (way(i, width), way(j, height));
                if di.unsigned_abs() <= radius && dj.unsigned_abs() <= radius {
                    scratch.block[0][i / LANES * height + j][i % LANES] = T::of(weight(di, dj));
                }
            }
        }
        let mut spectrum = vec![[T::default(); LANES]; height / LANES * width];
        isa.run(Down { transform: self, scratch });
        isa.run(Spectrum { transform: self, scratch, scale: T::of(scale), out: &mut spectrum });
        spectrum
    }

    /// Order of the frequencies across.
    pub(super) fn order(&self) -> Vec<usize> {
        self.across.order()
    }

    /// Returns where a spectrum holds the place `u` across and `v` down: the index of the lanes, and the lane.
    pub(super) fn at(&self, u: usize, v: usize) -> (usize, usize) {
        (v / LANES * self.width() + u, v % LANES)
    }

    /// Convolves the block. Only the columns of `wanted` are complete in the result.
    #[inline(always)]
    pub(super) fn convolve(&self, scratch: &mut Scratch<T>, spectrum: &[Lane<T>], wanted: std::ops::Range<usize>) {
        Down { transform: self, scratch }.run();
        Across { transform: self, scratch, spectrum }.run();
        let [real, imaginary] = &mut scratch.block;
        let height = self.height();
        let panels = wanted.start / LANES * height..wanted.end.div_ceil(LANES) * height;
        let (re, im) = (real[panels.clone()].chunks_exact_mut(height), imaginary[panels].chunks_exact_mut(height));
        for (re, im) in re.zip(im) {
            self.down.inverse(re, im);
        }
    }
}

/// Transposes a square: its rows become columns.
#[inline(always)]
fn turn<T: Real>(from: &[Lane<T>], to: &mut [Lane<T>]) {
    let (from, to) = (&from[..LANES], &mut to[..LANES]);
    for i in 0..LANES {
        for j in 0..LANES {
            to[i][j] = from[j][i];
        }
    }
}

/// Copies [`LANES`] rows of the block, from the row `row` on, to the line as columns.
#[inline(always)]
fn gather<T: Real>(block: &[Lane<T>], height: usize, row: usize, line: &mut [Lane<T>]) {
    for (panel, line) in block.chunks_exact(height).zip(line.chunks_exact_mut(LANES)) {
        turn(&panel[row..], line);
    }
}

/// Transforms down the columns of the block.
struct Down<'a, T> {
    transform: &'a Transform<T>,
    scratch: &'a mut Scratch<T>,
}

impl<T: Real> Vectorized for Down<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let [real, imaginary] = &mut self.scratch.block;
        let height = self.transform.height();
        for (re, im) in real.chunks_exact_mut(height).zip(imaginary.chunks_exact_mut(height)) {
            self.transform.down.forward(re, im);
        }
    }
}

/// Transforms across the rows, multiplies by the spectrum, and transforms back.
struct Across<'a, T> {
    transform: &'a Transform<T>,
    scratch: &'a mut Scratch<T>,
    spectrum: &'a [Lane<T>],
}

impl<T: Real> Across<'_, T> {
    #[inline(always)]
    fn run(self) {
        let Scratch { block, line: [re, im], .. } = self.scratch;
        let (width, height) = (self.transform.width(), self.transform.height());
        for (row, spectrum) in (0..height).step_by(LANES).zip(self.spectrum.chunks_exact(width)) {
            gather(&block[0], height, row, re);
            gather(&block[1], height, row, im);
            self.transform.across.forward(re, im);
            for line in [&mut *re, &mut *im] {
                for (v, s) in line.as_flattened_mut().iter_mut().zip(spectrum.as_flattened()) {
                    *v *= *s;
                }
            }
            self.transform.across.inverse(re, im);
            for (part, line) in block.iter_mut().zip([&*re, &*im]) {
                for (panel, line) in part.chunks_exact_mut(height).zip(line.chunks_exact(LANES)) {
                    turn(line, &mut panel[row..]);
                }
            }
        }
    }
}

/// Takes the real part of the spectrum if the block is a kernel; the imaginary part of a point-symmetric kernel is 0.
struct Spectrum<'a, T> {
    transform: &'a Transform<T>,
    scratch: &'a mut Scratch<T>,
    scale: T,
    out: &'a mut [Lane<T>],
}

impl<T: Real> Vectorized for Spectrum<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Scratch { block, line: [re, im], .. } = self.scratch;
        let (width, height) = (self.transform.width(), self.transform.height());
        for (row, out) in (0..height).step_by(LANES).zip(self.out.chunks_exact_mut(width)) {
            gather(&block[0], height, row, re);
            gather(&block[1], height, row, im);
            self.transform.across.forward(re, im);
            for (out, re) in out.as_flattened_mut().iter_mut().zip(re.as_flattened()) {
                *out = *re * self.scale;
            }
        }
    }
}
