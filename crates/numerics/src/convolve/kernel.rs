//! Kernels: how a unit of light in one pixel is spread over its neighbors.

/// Weights of the pixels around one pixel, symmetric under rotation by 90 degrees and under reflection.
#[derive(Clone, Debug)]
pub struct Kernel {
    radius: usize,
    /// Quarter of the weights, from the center on: the weight of the pixel `i` to the right and `j` down is at
    /// `j * (radius + 1) + i`.
    quarter: Vec<f64>,
}

impl Kernel {
    /// Creates a kernel. `weight(i, j)` is the weight of the pixels `i` across and `j` down from the center; it is called only
    /// for `j` of at least `i`.
    pub fn new(radius: usize, weight: impl Fn(usize, usize) -> f64 + Sync) -> Self {
        use rayon::prelude::*;
        let side = radius + 1;
        let triangle = |j: usize| (0..j + 1).map(|i| weight(i, j)).collect::<Vec<f64>>();
        let rows: Vec<Vec<f64>> = (0..side).into_par_iter().map(triangle).collect();
        let quarter = (0..side * side).map(|k| {
            let (i, j) = (k % side, k / side);
            rows[i.max(j)][i.min(j)]
        });
        Self { radius, quarter: quarter.collect() }
    }

    /// Radius of the kernel in pixels: the largest offset across or down.
    pub fn radius(&self) -> usize {
        self.radius
    }

    /// Weight of the pixels `i` across and `j` down from the center.
    pub fn weight(&self, i: usize, j: usize) -> f64 {
        self.quarter[j * (self.radius + 1) + i]
    }

    /// Returns the weights by how far a pixel lies to the right and down.
    pub(super) fn signed(&self) -> impl Fn(isize, isize) -> f64 + '_ {
        |i, j| self.weight(i.unsigned_abs(), j.unsigned_abs())
    }

    /// Sum of all weights.
    pub fn sum(&self) -> f64 {
        let times = |k: usize| if k == 0 { 1.0 } else { 2.0 };
        let side = self.radius + 1;
        self.quarter.iter().enumerate().map(|(k, w)| w * times(k % side) * times(k / side)).sum()
    }

    /// Multiplies all weights by `factor`.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        self.quarter.iter_mut().for_each(|w| *w *= factor);
        self
    }

    /// Subtracts `by` times the Laplacian of the kernel. The result has the same sum. Its variance along each axis is smaller by
    /// 2 `by`, in squared pixels.
    #[must_use]
    pub fn sharpened(&self, by: f64) -> Self {
        let at = |i: usize, j: usize| if i.max(j) > self.radius { 0.0 } else { self.weight(i, j) };
        Self::new(self.radius + 1, |i, j| {
            let around = at(i.abs_diff(1), j) + at(i + 1, j) + at(i, j.abs_diff(1)) + at(i, j + 1);
            at(i, j) - (around - 4.0 * at(i, j)) * by
        })
    }

    /// Removes all weights beyond `radius` pixels across or down.
    #[must_use]
    pub fn cropped(self, radius: usize) -> Self {
        if radius >= self.radius { self } else { Self::new(radius, |i, j| self.weight(i, j)) }
    }
}
