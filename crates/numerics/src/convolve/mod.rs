//! Convolution of a plane with a small point-symmetric kernel (the same weight at opposite places), block by block.
//!
//! Each block of the picture is transformed together with a margin as wide as the kernel's radius (overlap-save; T. G.
//! Stockham, "High-speed convolution and correlation", AFIPS 1966). Memory is therefore that of a few blocks, and the result
//! depends on the plane alone, not on the threads. Outside the plane there is no light, and nothing wraps around.
//!
//! Sums in double precision leave the shadows in the block of a bright point as they were. Single precision takes a third of
//! the time. Its rounding is some 1e-7 of the root mean square of a block's result, all over the block. That is enough if no
//! pixel keeps most of its own light, as in a wide kernel without its unscattered part.

mod block;
mod fft;
mod grid;
mod kernel;
mod products;
mod real;

pub use grid::Grid;
pub use kernel::Kernel;
pub use products::Products;
pub use real::Real;

use crate::isa::{Isa, Vectorized};
use block::{Scratch, Transform};
use fft::Lane;
use rayon::prelude::*;

/// Longest side of a block, unless the kernel asks for more.
const LONGEST_SIDE: usize = 512;

/// A kernel that is prepared for the convolution of planes of one size.
pub struct Convolver<T: Real = f64> {
    width: usize,
    height: usize,
    radius: usize,
    transform: Transform<T>,
    /// Spectrum of the kernel divided by the number of points, in the order of the transform.
    spectrum: Vec<Lane<T>>,
    isa: Isa,
}

impl<T: Real> Convolver<T> {
    /// Prepares `kernel` for planes of `width` by `height` pixels.
    pub fn new(kernel: &Kernel, width: usize, height: usize) -> Self {
        Self::of(kernel.radius(), kernel.signed(), width, height)
    }

    /// Prepares a kernel given as a function of how far a pixel lies to the right and down, up to `radius` pixels. The function
    /// must have the same value at opposite offsets.
    pub fn of(radius: usize, weight: impl Fn(isize, isize) -> f64, width: usize, height: usize) -> Self {
        let isa = Isa::detect();
        let transform = Transform::new(side(width, radius), side(height, radius));
        let spectrum = transform.spectrum(radius, weight, isa);
        Self { width, height, radius, transform, spectrum, isa }
    }

    /// Convolves the plane `source`. For each pixel, `write` gets the element of `target` and the convolved value.
    ///
    /// # Panics
    /// If the size of a plane differs from the one that was prepared for.
    pub fn apply(&self, source: &[f32], target: &mut [f32], write: impl Fn(&mut f32, T) + Sync) {
        self.apply_at(source, target, |to, v, _| write(to, v));
    }

    /// Convolves the plane `source`. For each pixel, `write` gets the element of `target`, the convolved value, and the pixel's
    /// column and row.
    ///
    /// # Panics
    /// If the size of a plane differs from the one that was prepared for.
    pub fn apply_at(&self, source: &[f32], target: &mut [f32], write: impl Fn(&mut f32, T, [usize; 2]) + Sync) {
        assert_eq!(source.len(), self.width * self.height, "the plane has the size that was prepared for");
        assert_eq!(target.len(), source.len(), "both planes have the same size");
        if source.is_empty() {
            return;
        }
        let tile = [self.transform.width() - 2 * self.radius, self.transform.height() - 2 * self.radius];
        target.par_chunks_mut(self.width * tile[1]).enumerate().for_each_init(
            || (Scratch::new(&self.transform), vec![T::default(); tile[0]]),
            |(scratch, line), (strip, target)| {
                let y0 = strip * tile[1];
                self.isa.run(Strip { convolver: self, source, y0, tile, target, scratch, line, write: &write });
            },
        );
    }
}

impl Convolver {
    /// Estimates the arithmetic operations per pixel of a convolution with a kernel of `radius` on planes of `width` by `height`.
    /// It counts the forward and inverse transforms of a tile, divided by the pixels that the tile yields.
    #[must_use]
    pub fn operations(radius: usize, width: usize, height: usize) -> usize {
        let sides = [side(width, radius), side(height, radius)];
        let points = sides[0] * sides[1];
        // Forward and inverse, five operations per point and step.
        5 * points * points.trailing_zeros() as usize / ((sides[0] - 2 * radius) * (sides[1] - 2 * radius))
    }
}

/// The rows of a plane from `y0` on.
struct Strip<'a, T: Real, F> {
    convolver: &'a Convolver<T>,
    source: &'a [f32],
    y0: usize,
    tile: [usize; 2],
    target: &'a mut [f32],
    scratch: &'a mut Scratch<T>,
    line: &'a mut [T],
    write: &'a F,
}

impl<T: Real, F: Fn(&mut f32, T, [usize; 2])> Vectorized for Strip<'_, T, F> {
    type Output = ();

    /// Convolves two tiles at a time: one is the real part, one the imaginary part. The kernel is the same at opposite places,
    /// so its spectrum is real and the two do not mix.
    #[inline(always)]
    fn run(self) {
        let Self { convolver, source, y0, tile, target, scratch, line, write } = self;
        let Convolver { width, height, radius, transform, spectrum, .. } = convolver;
        for x0 in (0..*width).step_by(2 * tile[0]) {
            let x1 = x0 + tile[0];
            scratch.load(source, [*width, *height], [x0, x1], y0, *radius);
            transform.convolve(scratch, spectrum, *radius..radius + tile[0]);
            for (part, x) in [(0, x0), (1, x1)] {
                let columns = tile[0].min(width.saturating_sub(x));
                if columns == 0 {
                    continue;
                }
                for (row, target) in target.chunks_exact_mut(*width).enumerate() {
                    let line = &mut line[..columns];
                    scratch.read(part, radius + row, *radius, line);
                    for (column, (to, v)) in (x..).zip(target[x..x + columns].iter_mut().zip(line.iter())) {
                        write(to, *v, [column, y0 + row]);
                    }
                }
            }
        }
    }
}

/// Returns the side of a block along an axis of `length` pixels that costs the least work.
fn side(length: usize, radius: usize) -> usize {
    let least = (2 * radius + 2).next_power_of_two().max(fft::LANES);
    let most = LONGEST_SIDE.max(2 * least);
    let sides = std::iter::successors(Some(least), |s| Some(s * 2)).take_while(|s| *s <= most);
    let cost = |s: &usize| length.div_ceil(s - 2 * radius) * s * (2 + s.trailing_zeros() as usize);
    sides.min_by_key(cost).unwrap_or(least)
}

#[cfg(test)]
mod tests;
