//! Two-dimensional transforms of one block.

use super::fft::{Fft, LANES, Lane};
use crate::isa::{Isa, Vectorized};

/// Transforms of blocks of one size.
pub(super) struct Transform {
    across: Fft,
    down: Fft,
}

/// Blocks under work.
pub(super) struct Scratch {
    /// Rows by columns.
    block: [Vec<f64>; 2],
    /// Columns by rows.
    turned: [Vec<f64>; 2],
    re: Vec<Lane>,
    im: Vec<Lane>,
    width: usize,
}

impl Scratch {
    pub(super) fn new(transform: &Transform) -> Self {
        let pixels = transform.width() * transform.height();
        let side = transform.width().max(transform.height());
        let plane = || vec![0.0; pixels];
        let lanes = || vec![[0.0; LANES]; side];
        Self {
            block: [plane(), plane()],
            turned: [plane(), plane()],
            re: lanes(),
            im: lanes(),
            width: transform.width(),
        }
    }

    /// Fills the block's two parts with what lies around the tiles that start at the columns `x0` and the row `y0`
    /// of a plane of size `size`; what is beside the plane, or no number, is 0.
    pub(super) fn load(&mut self, plane: &[f32], size: [usize; 2], x0: [usize; 2], y0: usize, radius: usize) {
        for (block, x0) in self.block.iter_mut().zip(x0) {
            // Columns of the block that lie on the plane: column c is x = x0 + c - radius.
            let first = radius.saturating_sub(x0).min(self.width);
            let last = (size[0] + radius).saturating_sub(x0).min(self.width).max(first);
            for (row, line) in block.chunks_exact_mut(self.width).enumerate() {
                let y = (y0 + row).checked_sub(radius).filter(|y| *y < size[1]);
                let Some(y) = y else {
                    line.fill(0.0);
                    continue;
                };
                line[..first].fill(0.0);
                line[last..].fill(0.0);
                if first < last {
                    let from = y * size[0] + x0 + first - radius;
                    for (to, from) in line[first..last].iter_mut().zip(&plane[from..]) {
                        *to = if from.is_finite() { f64::from(*from) } else { 0.0 };
                    }
                }
            }
        }
    }

    /// A value of the block's part 0 or 1.
    #[inline(always)]
    pub(super) fn value(&self, part: usize, at: usize) -> f64 {
        self.block[part][at]
    }
}

impl Transform {
    /// Blocks of `width` by `height`, powers of two of at least [`LANES`].
    pub(super) fn new(width: usize, height: usize) -> Self {
        Self { across: Fft::new(width), down: Fft::new(height) }
    }

    pub(super) fn width(&self) -> usize {
        self.across.length()
    }

    pub(super) fn height(&self) -> usize {
        self.down.length()
    }

    /// The spectrum, over the number of points, of weights that are the same at opposite places: column chunk by column chunk.
    pub(super) fn spectrum(&self, radius: usize, weight: impl Fn(isize, isize) -> f64, isa: Isa) -> Vec<f64> {
        let scale = 1.0 / (self.width() * self.height()) as f64;
        self.spectrum_with(radius, weight, &mut Scratch::new(self), scale, isa)
    }

    /// The spectrum of weights times `scale`; weights as wide as the block wrap around once.
    pub(super) fn spectrum_with(
        &self,
        radius: usize,
        weight: impl Fn(isize, isize) -> f64,
        scratch: &mut Scratch,
        scale: f64,
        isa: Isa,
    ) -> Vec<f64> {
        let (width, height) = (self.width(), self.height());
        scratch.block.iter_mut().for_each(|part| part.fill(0.0));
        // The way from the origin, around the block.
        let way = |k: usize, length: usize| if 2 * k <= length { k as isize } else { k as isize - length as isize };
        for j in 0..height {
            for i in 0..width {
                let (di, dj) = (way(i, width), way(j, height));
                if di.unsigned_abs() <= radius && dj.unsigned_abs() <= radius {
                    scratch.block[0][j * width + i] = weight(di, dj);
                }
            }
        }
        let mut spectrum = vec![0.0; width * height];
        isa.run(Forward { transform: self, scratch });
        isa.run(Spectrum { transform: self, scratch, scale, out: &mut spectrum });
        spectrum
    }

    /// Order of the frequencies across.
    pub(super) fn order(&self) -> Vec<usize> {
        self.across.order()
    }

    /// Where a spectrum holds the place `u` across and `v` down.
    pub(super) fn at(&self, u: usize, v: usize) -> usize {
        (v / LANES * self.width() + u) * LANES + v % LANES
    }

    /// Convolves the block.
    pub(super) fn convolve(&self, scratch: &mut Scratch, spectrum: &[f64], isa: Isa) {
        isa.run(Forward { transform: self, scratch });
        isa.run(Multiply { transform: self, scratch, spectrum });
        isa.run(Backward { transform: self, scratch });
    }
}

/// Reads [`LANES`] columns of a plane of `columns` columns, from column `c` on.
#[inline(always)]
fn gather(plane: &[f64], columns: usize, c: usize, lanes: &mut [Lane]) {
    for (lane, row) in lanes.iter_mut().zip(plane.chunks_exact(columns)) {
        lane.copy_from_slice(&row[c..c + LANES]);
    }
}

/// Writes [`LANES`] columns of `rows` values as rows of the turned plane, from row `c` on.
#[inline(always)]
fn scatter_turned(lanes: &[Lane], rows: usize, c: usize, turned: &mut [f64]) {
    for l in 0..LANES {
        for (to, lane) in turned[(c + l) * rows..][..rows].iter_mut().zip(lanes) {
            *to = lane[l];
        }
    }
}

/// Down the columns of the block, into the turned planes.
struct Forward<'a> {
    transform: &'a Transform,
    scratch: &'a mut Scratch,
}

impl Vectorized for Forward<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Scratch { block, turned, re, im, .. } = self.scratch;
        let (width, height) = (self.transform.width(), self.transform.height());
        for c in (0..width).step_by(LANES) {
            gather(&block[0], width, c, re);
            gather(&block[1], width, c, im);
            self.transform.down.forward(re, im);
            scatter_turned(re, height, c, &mut turned[0]);
            scatter_turned(im, height, c, &mut turned[1]);
        }
    }
}

/// Across, times the spectrum, and back, from the turned planes into the block.
struct Multiply<'a> {
    transform: &'a Transform,
    scratch: &'a mut Scratch,
    spectrum: &'a [f64],
}

impl Vectorized for Multiply<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Scratch { block, turned, re, im, .. } = self.scratch;
        let (width, height) = (self.transform.width(), self.transform.height());
        for (c, spectrum) in (0..height).step_by(LANES).zip(self.spectrum.chunks_exact(width * LANES)) {
            gather(&turned[0], height, c, re);
            gather(&turned[1], height, c, im);
            self.transform.across.forward(re, im);
            for ((re, im), s) in re.iter_mut().zip(im.iter_mut()).zip(spectrum.chunks_exact(LANES)) {
                for l in 0..LANES {
                    re[l] *= s[l];
                    im[l] *= s[l];
                }
            }
            self.transform.across.inverse(re, im);
            scatter_turned(re, width, c, &mut block[0]);
            scatter_turned(im, width, c, &mut block[1]);
        }
    }
}

/// Back down the columns, in the block.
struct Backward<'a> {
    transform: &'a Transform,
    scratch: &'a mut Scratch,
}

impl Vectorized for Backward<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Scratch { block, re, im, .. } = self.scratch;
        let width = self.transform.width();
        for c in (0..width).step_by(LANES) {
            gather(&block[0], width, c, re);
            gather(&block[1], width, c, im);
            self.transform.down.inverse(re, im);
            for (part, lanes) in block.iter_mut().zip([&*re, &*im]) {
                for (row, lane) in part.chunks_exact_mut(width).zip(lanes) {
                    row[c..c + LANES].copy_from_slice(lane);
                }
            }
        }
    }
}

/// The real part of the spectrum, where the block is a kernel: the imaginary one of what is the same at opposite places is 0.
struct Spectrum<'a> {
    transform: &'a Transform,
    scratch: &'a mut Scratch,
    scale: f64,
    out: &'a mut [f64],
}

impl Vectorized for Spectrum<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Scratch { turned, re, im, .. } = self.scratch;
        let (width, height) = (self.transform.width(), self.transform.height());
        for (c, out) in (0..height).step_by(LANES).zip(self.out.chunks_exact_mut(width * LANES)) {
            gather(&turned[0], height, c, re);
            gather(&turned[1], height, c, im);
            self.transform.across.forward(re, im);
            for (out, re) in out.chunks_exact_mut(LANES).zip(re.iter()) {
                for l in 0..LANES {
                    out[l] = re[l] * self.scale;
                }
            }
        }
    }
}
