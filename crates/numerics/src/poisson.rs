//! Random counts from the Poisson distribution.

use crate::math::{exp, lgamma, log};
use crate::normal;

/// Above this mean the sum of the distribution's terms is long, and an expansion about the normal distribution is exact to 1 in
/// 10^4 of the standard deviation.
const MANY: f64 = 500.0;

/// Returns the quantile `u`, in [0, 1), of the Poisson distribution with this `mean`: the smallest count whose cumulative
/// probability exceeds `u`. Returns 0 if the mean is not positive.
///
/// Above a mean of 500 it uses the expansion of E. A. Cornish and R. A. Fisher (1938) to the third order.
#[must_use]
pub fn quantile(mean: f64, u: f64) -> f64 {
    if !(mean > 0.0) {
        return 0.0;
    }
    if mean > MANY {
        let (root, z) = (mean.sqrt(), normal::quantile(u.max(f64::MIN_POSITIVE)));
        return (mean + root * z + (z * z - 1.0) / 6.0 + (z - z * z * z) / (72.0 * root)).round().max(0.0);
    }
    let (mut count, mut part) = (0.0, exp(-mean));
    let mut below = part;
    while u >= below {
        count += 1.0;
        part *= mean / count;
        if count > mean && below + part == below {
            break; // rounding keeps the sum below `u`
        }
        below += part;
    }
    count
}

/// Draws a Poisson count with this `mean`, exact for any mean; 0 if the mean is not positive. `uniform` returns independent
/// numbers in (0, 1). Below a mean of 10 it uses [`quantile`], else transformed rejection (PTRS; W. Hörmann, Insurance:
/// Mathematics and Economics 12, 39 (1993)).
pub fn draw(mean: f64, mut uniform: impl FnMut() -> f64) -> f64 {
    if !(mean >= 10.0) {
        return if mean > 0.0 { quantile(mean, uniform()) } else { 0.0 };
    }
    let root = mean.sqrt();
    let b = 0.931 + 2.53 * root;
    let a = -0.059 + 0.02483 * b;
    let inverse_alpha = 1.1239 + 1.1328 / (b - 3.4);
    let ratio = 0.9277 - 3.6224 / (b - 2.0);
    let log_mean = log(mean);
    loop {
        let u = uniform() - 0.5;
        let v = uniform();
        let us = 0.5 - u.abs();
        let k = ((2.0 * a / us + b) * u + mean + 0.43).floor();
        if us >= 0.07 && v <= ratio {
            return k;
        }
        if k < 0.0 || (us < 0.013 && v > us) {
            continue;
        }
        let left = log(v) + log(inverse_alpha) - log(a / (us * us) + b);
        if left <= k * log_mean - mean - lgamma(k + 1.0) {
            return k;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::SplitMix64;

    /// Mean and variance of a Poisson number are its mean, the third central moment too; each within five standard errors
    /// (those of the moments of a Poisson number, by its cumulants). A quantile is rounded from the expansion: 1/12 of variance.
    #[test]
    fn counts_have_poissons_moments() {
        let n = 200_000;
        let mut random = SplitMix64::new(7);
        let mut next = || random.open_unit();
        for mean in [0.1, 2.0, 9.9, 10.1, 60.0, 499.0, 501.0, 5000.0] {
            let quantiles: Vec<f64> = (0..n).map(|_| quantile(mean, next())).collect();
            let drawn: Vec<f64> = (0..n).map(|_| draw(mean, &mut next)).collect();
            for (counts, rounded) in [(quantiles, if mean > MANY { 1.0 / 12.0 } else { 0.0 }), (drawn, 0.0)] {
                let moment = |k: i32| counts.iter().map(|c| (c - mean).powi(k)).sum::<f64>() / f64::from(n);
                let error = |variance: f64| 5.0 * (variance / f64::from(n)).sqrt();
                assert!(moment(1).abs() < error(mean), "{mean}: {}", moment(1));
                assert!((moment(2) - mean - rounded).abs() < error(mean + 2.0 * mean * mean), "{mean}: {}", moment(2));
                let sixth = mean + 25.0 * mean * mean + 15.0 * mean.powi(3);
                assert!((moment(3) - mean).abs() < error(sixth - mean * mean), "{mean}: {}", moment(3));
                let none = counts.iter().filter(|c| **c == 0.0).count() as f64 / f64::from(n);
                assert!((none - exp(-mean)).abs() <= error(exp(-mean)), "{mean}: {none}");
            }
        }
        assert_eq!([quantile(0.0, 0.9), quantile(-1.0, 0.9), quantile(f64::NAN, 0.9)], [0.0; 3]);
        assert_eq!([draw(0.0, &mut next), draw(-1.0, &mut next), draw(f64::NAN, &mut next)], [0.0; 3]);
        assert_eq!(quantile(2.0, 0.0), 0.0);
    }

    /// On both sides of the border the expansion and the sum give counts that differ by one at most, also far out.
    #[test]
    fn the_expansion_joins_the_sum() {
        for i in 0..2000 {
            let u = (f64::from(i) + 0.5) / 2000.0;
            let (below, above) = (quantile(MANY, u), quantile(MANY * (1.0 + 1e-12), u));
            assert!((below - above).abs() <= 1.0, "{u}: {below} {above}");
        }
        for (u, apart) in [(0.0, f64::INFINITY), (1e-12, 2.0), (1.0 - 1e-12, 2.0), (1.0 - 0.5 * f64::EPSILON, 20.0)] {
            let (below, above) = (quantile(MANY, u), quantile(MANY * (1.0 + 1e-12), u));
            assert!(above.is_finite() && below < MANY + 10.0 * MANY.sqrt(), "{u}: {below} {above}");
            assert!((below - above).abs() <= apart, "{u}: {below} {above}");
        }
    }
}
