//! Transforms of symmetric weights to symmetric weights, for the design of kernels.

use super::block::{Scratch, Transform};
use super::kernel::Kernel;
use crate::isa::Isa;

/// A square grid of pixels that wraps around, for transforms of kernels.
pub struct Grid {
    transform: Transform<f64>,
    scratch: Scratch<f64>,
    /// Place of each frequency in a transform.
    place: Vec<usize>,
    isa: Isa,
}

impl Grid {
    /// Creates a grid of `side` by `side` points, where `side` is a power of two of at least 16.
    pub fn new(side: usize) -> Self {
        let transform = Transform::new(side, side);
        let scratch = Scratch::new(&transform);
        let mut place = vec![0; side];
        transform.order().iter().enumerate().for_each(|(at, frequency)| place[*frequency] = at);
        Self { transform, scratch, place, isa: Isa::detect() }
    }

    /// Computes the Fourier transform of `weights` for u and v from 0 to half a side: the sum over the grid of the weights times
    /// exp(-2 pi i (u x + v y) / side). It is real because the weights are symmetric. Applied twice it returns the weights, times
    /// the number of points.
    pub fn transform(&mut self, weights: &Kernel) -> Kernel {
        let side = self.transform.width();
        let spectrum =
            self.transform.spectrum_with(weights.radius(), weights.signed(), &mut self.scratch, 1.0, self.isa);
        Kernel::new(side / 2, |u, v| {
            let (lanes, lane) = self.transform.at(self.place[u], self.place[v]);
            spectrum[lanes][lane]
        })
    }
}
