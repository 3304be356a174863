//! Photon noise and read noise of electron counts, from counter-based random numbers of each pixel.

use spectra_core::math::{cos, log};
use spectra_core::numbers::{GOLDEN, SplitMix64, mix64};
use spectra_numerics::poisson;

/// Stream of random numbers of one pixel.
pub struct PixelNumbers(SplitMix64);

impl PixelNumbers {
    /// Creates the stream of `pixel` for a seed.
    #[must_use]
    pub fn new(seed: u64, pixel: u64) -> Self {
        Self(SplitMix64::new(mix64(mix64(seed.wrapping_add(GOLDEN)) ^ mix64(pixel.wrapping_mul(GOLDEN)))))
    }

    /// Draws a uniform random number in (0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.0.open_unit()
    }

    /// Draws a normal random number of mean 0 and variance 1 (G. E. P. Box, M. E. Muller, 1958).
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (self.uniform(), self.uniform());
        (-2.0 * log(u)).sqrt() * cos(std::f64::consts::TAU * v)
    }

    /// Draws from the exact Poisson distribution with this mean.
    pub fn poisson(&mut self, mean: f64) -> f64 {
        poisson::draw(mean, || self.uniform())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_are_normal() {
        let n = 200_000;
        let values: Vec<f64> = (0..n).map(|pixel| PixelNumbers::new(3, pixel).normal()).collect();
        let moment = |k: i32| values.iter().map(|c| c.powi(k)).sum::<f64>() / n as f64;
        for (k, want, variance) in [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0)] {
            assert!((moment(k) - want).abs() < 5.0 * (variance / n as f64).sqrt(), "{k}: {}", moment(k));
        }
    }
}
