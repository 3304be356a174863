//! Numbers of electrons, with the scatter that nature and electronics give them: counter-based, pixel by pixel.

use spectra_core::math::{cos, log};
use spectra_core::numbers::mix64;
use spectra_numerics::poisson;

const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// Random numbers of one pixel.
pub struct PixelNumbers {
    key: u64,
    count: u64,
}

impl PixelNumbers {
    /// Those of `pixel` under a seed.
    #[must_use]
    pub fn new(seed: u64, pixel: u64) -> Self {
        Self { key: mix64(mix64(seed.wrapping_add(GOLDEN)) ^ mix64(pixel.wrapping_mul(GOLDEN))), count: 0 }
    }

    /// Uniform in (0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.count += 1;
        let bits = mix64(self.key.wrapping_add(self.count.wrapping_mul(GOLDEN)));
        ((bits >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }

    /// Normal, of mean 0 and variance 1 (G. E. P. Box, M. E. Muller, 1958).
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (self.uniform(), self.uniform());
        (-2.0 * log(u)).sqrt() * cos(std::f64::consts::TAU * v)
    }

    /// Poisson, exact.
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
