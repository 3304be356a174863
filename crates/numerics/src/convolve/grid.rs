//! Transforms of symmetric weights to symmetric weights, for the design of kernels.

use super::block::{Scratch, Transform};
use super::kernel::Kernel;
use crate::isa::Isa;

/// A square grid that wraps around.
pub struct Grid {
    transform: Transform<f64>,
    scratch: Scratch<f64>,
    /// Place of each frequency in a transform.
    place: Vec<usize>,
    isa: Isa,
}

impl Grid {
    /// Creates a grid of `side` by `side` points, a power of two of at least 16.
    pub fn new(side: usize) -> Self {
        let transform = Transform::new(side, side);
        let scratch = Scratch::new(&transform);
        let mut place = vec![0; side];
        transform.order().iter().enumerate().for_each(|(at, frequency)| place[*frequency] = at);
        Self { transform, scratch, place, isa: Isa::detect() }
    }

    /// Computes the sum over the grid of the weights times exp(-2 pi i (u x + v y) / side), for u and v up to half a side. The
    /// weights are symmetric, so this is real, and its own inverse except for a factor, the number of points.
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
