//! Numbers of electrons, with the scatter that nature and electronics give them: counter-based, pixel by pixel.

use spectra_core::math::{cos, exp, log};
use spectra_core::numbers::mix64;

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

    /// Poisson, exact: by inversion where few are expected, else by W. Hörmann's transformed rejection (PTRS, Insurance:
    /// Mathematics and Economics 12, 39 (1993)).
    pub fn poisson(&mut self, mean: f64) -> f64 {
        if !(mean > 0.0) {
            return 0.0;
        }
        if mean < 10.0 {
            let (mut count, mut term, u) = (0.0, exp(-mean), self.uniform());
            let mut sum = term;
            while u > sum && count < 200.0 {
                count += 1.0;
                term *= mean / count;
                sum += term;
            }
            return count;
        }
        let root = mean.sqrt();
        let b = 0.931 + 2.53 * root;
        let a = -0.059 + 0.02483 * b;
        let inverse_alpha = 1.1239 + 1.1328 / (b - 3.4);
        let ratio = 0.9277 - 3.6224 / (b - 2.0);
        let log_mean = log(mean);
        loop {
            let u = self.uniform() - 0.5;
            let v = self.uniform();
            let us = 0.5 - u.abs();
            let k = ((2.0 * a / us + b) * u + mean + 0.43).floor();
            if us >= 0.07 && v <= ratio {
                return k;
            }
            if k < 0.0 || (us < 0.013 && v > us) {
                continue;
            }
            let left = log(v) + log(inverse_alpha) - log(a / (us * us) + b);
            if left <= k * log_mean - mean - libm::lgamma(k + 1.0) {
                return k;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean and variance of a Poisson number are its mean, the third central moment too; each within five standard errors
    /// (those of the moments of a Poisson number, by its cumulants).
    #[test]
    fn counts_have_poissons_moments() {
        let n = 200_000;
        for mean in [0.3, 4.0, 9.9, 10.1, 60.0, 5000.0] {
            let counts: Vec<f64> = (0..n).map(|pixel| PixelNumbers::new(7, pixel).poisson(mean)).collect();
            let moment = |k: i32| counts.iter().map(|c| (c - mean).powi(k)).sum::<f64>() / n as f64;
            let error = |variance: f64| 5.0 * (variance / n as f64).sqrt();
            assert!(moment(1).abs() < error(mean), "{mean}: {}", moment(1));
            assert!((moment(2) - mean).abs() < error(mean + 2.0 * mean * mean), "{mean}: {}", moment(2));
            let sixth = mean + 25.0 * mean * mean + 15.0 * mean.powi(3);
            assert!((moment(3) - mean).abs() < error(sixth - mean * mean), "{mean}: {}", moment(3));
        }
    }

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
