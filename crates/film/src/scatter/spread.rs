//! The spread of a point: a sum of Gaussians, and its integral over each pixel.

use spectra_core::math::{exp, log};
use spectra_numerics::convolve::Kernel;
use spectra_numerics::normal;
use std::f64::consts::PI;

/// Point spread of light, a sum of Gaussians: round, positive, and decreasing with the distance.
#[derive(Clone, Debug, PartialEq)]
pub struct PointSpread {
    /// Standard deviation along an axis (mm) and weight of each Gaussian; the weights sum to 1.
    terms: Vec<[f64; 2]>,
}

impl PointSpread {
    /// Builds a sum of Gaussians from standard deviations along an axis (mm) and weights, all above 0. Weights are scaled so that they sum
    /// to 1.
    pub(crate) fn new(terms: Vec<[f64; 2]>) -> Self {
        let sum: f64 = terms.iter().map(|t| t[1]).sum();
        Self { terms: terms.into_iter().map(|[sigma, weight]| [sigma, weight / sum]).collect() }
    }

    /// Builds the spread with the response 1 / (1 + (2 pi l f)^2), which is K0(r / l) / (2 pi l^2): diffusion with loss, and Frieser's
    /// scatter.
    ///
    /// 1 / (1 + x^2) is the integral of exp(-t (1 + x^2)) over t from 0 on: one Gaussian for each t. Equal steps of log t give a sum within
    /// 1e-6 of the integral.
    pub(crate) fn bessel(length_mm: f64) -> Self {
        const STEP: f64 = 0.5;
        let term = |k: i32| {
            let t = exp(f64::from(k) * STEP);
            // exp(-t (2 pi l f)^2) has the deviation l sqrt(2 t).
            [length_mm * (2.0 * t).sqrt(), t * exp(-t)]
        };
        Self::new((-30..7).map(term).collect())
    }

    /// Standard deviation along an axis (mm) and weight of each Gaussian; the weights sum to 1.
    #[must_use]
    pub fn terms(&self) -> &[[f64; 2]] {
        &self.terms
    }

    /// Returns the fraction of the light per mm^2 at the distance `r_mm` from the point.
    #[must_use]
    pub fn per_mm2(&self, r_mm: f64) -> f64 {
        let term = |[s, w]: &[f64; 2]| w * exp(-r_mm * r_mm / (2.0 * s * s)) / (2.0 * PI * s * s);
        self.terms.iter().map(term).sum()
    }

    /// Returns the fraction of contrast that a sine of `frequency` cycles/mm keeps.
    #[must_use]
    pub fn response(&self, frequency: f64) -> f64 {
        let term = |[s, w]: &[f64; 2]| {
            let x = PI * s * frequency;
            w * exp(-2.0 * x * x)
        };
        self.terms.iter().map(term).sum()
    }

    /// Returns the distance (mm) beyond which less than `share` of the light lies.
    pub(crate) fn reach_mm(&self, share: f64) -> f64 {
        // The part exp(-r^2 / (2 s^2)) of a Gaussian lies beyond r.
        let beyond = |r: f64| self.terms.iter().map(|[s, w]| w * exp(-r * r / (2.0 * s * s))).sum::<f64>();
        let widest = self.terms.iter().map(|t| t[0]).fold(0.0, f64::max);
        let (mut left, mut right) = (0.0, widest * (-2.0 * log(share)).sqrt());
        for _ in 0..30 {
            let middle = 0.5 * (left + right);
            if beyond(middle) > share { left = middle } else { right = middle }
        }
        right
    }

    /// Integrates the spread of a point in the center of a pixel over the pixels around it, each `pitch_mm` wide. Leaves out at most
    /// `share` of the light, and reaches at most `most` pixels. The kernel sums to 1.
    pub(crate) fn over_pixels(&self, pitch_mm: f64, share: f64, most: usize) -> Kernel {
        let all = self.profiles(pitch_mm, share, most);
        let kernel = Kernel::new(all[0].1.len() - 1, |i, j| all.iter().map(|(w, a)| w * a[i] * a[j]).sum());
        let sum = kernel.sum();
        kernel.scaled(1.0 / sum)
    }

    /// Integrates the spread over pixels as [`PointSpread::over_pixels`] does, as a sum of products. Returns for each Gaussian its weight,
    /// and its integrals over the pixels along an axis, from the center on. Together they sum to 1.
    pub(crate) fn profiles(&self, pitch_mm: f64, share: f64, most: usize) -> Vec<(f64, Vec<f64>)> {
        let radius = ((self.reach_mm(share) / pitch_mm).ceil() as usize).max(1).min(most);
        // Integrals are computed on the falling side, without cancellation.
        let along = |sigma: f64| -> Vec<f64> {
            let beyond = |i: usize| normal::cdf(-(i as f64 + 0.5) * pitch_mm / sigma);
            (0..=radius).map(|i| if i == 0 { 1.0 - 2.0 * beyond(0) } else { beyond(i - 1) - beyond(i) }).collect()
        };
        let all = |a: &Vec<f64>| a[0] + 2.0 * a[1..].iter().sum::<f64>();
        let mut profiles: Vec<(f64, Vec<f64>)> = self.terms.iter().map(|[s, w]| (*w, along(*s))).collect();
        let sum: f64 = profiles.iter().map(|(w, a)| w * all(a) * all(a)).sum();
        profiles.iter_mut().for_each(|(w, _)| *w /= sum);
        profiles
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with the exact response, and with K0 by its integral (Abramowitz and Stegun 9.6.24).
    #[test]
    fn diffusion_with_loss_is_a_sum_of_gaussians() {
        let (l, spread) = (0.03, PointSpread::bessel(0.03));
        for f in [0.0, 0.5, 3.0, 20.0, 100.0] {
            let x = 2.0 * PI * l * f;
            assert!((spread.response(f) - 1.0 / (1.0 + x * x)).abs() < 1e-6, "{f}");
        }
        for x in [0.1, 0.5, 1.0, 4.0, 8.0] {
            let cosh = |t: f64| (exp(t) + exp(-t)) / 2.0;
            let k0: f64 = (0..40_000).map(|i| exp(-x * cosh((f64::from(i) + 0.5) * 5e-4)) * 5e-4).sum();
            let got = spread.per_mm2(x * l) * 2.0 * PI * l * l;
            assert!((got / k0 - 1.0).abs() < 1e-4, "{x}: {got} {k0}");
        }
    }

    /// The fraction `share` lies beyond the reach, by integration over rings.
    #[test]
    fn reach_is_where_the_share_is_left() {
        let spread = PointSpread::new(vec![[0.003, 3.0], [0.011, 1.0]]);
        let reach = spread.reach_mm(1e-4);
        let step = 1e-5;
        let rings = (0..20_000).map(|i| reach + (f64::from(i) + 0.5) * step);
        let left: f64 = rings.map(|r| spread.per_mm2(r) * 2.0 * PI * r * step).sum();
        assert!((left / 1e-4 - 1.0).abs() < 1e-3, "{left}");
    }
}
