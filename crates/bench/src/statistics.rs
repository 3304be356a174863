//! Errors over seeds with confidence intervals.

use crate::report::Interval;
use spectra_core::numbers::SplitMix64;

/// Relative errors below this are due to rounding, not to sampling.
pub(crate) const ROUNDING: f64 = 1e-12;

/// Number of resamples of the bootstrap.
const RESAMPLES: usize = 1000;

/// Errors for each number of samples, and the slope, all with 95 % intervals.
#[derive(Debug)]
pub(crate) struct Fitted {
    pub errors: Vec<Interval>,
    pub slope: Option<Interval>,
}

/// Computes errors and slope from squared errors: for each number of samples a list over seeds.
pub(crate) fn fit(samples: &[u32], squared: &[Vec<f64>]) -> Fitted {
    let errors: Vec<f64> = squared.iter().map(|s| root_mean(s.iter().copied(), s.len())).collect();
    let slope = slope(samples, &errors);
    let mut again = vec![Vec::with_capacity(RESAMPLES); squared.len()];
    let mut slopes = Vec::with_capacity(RESAMPLES);
    let mut random = SplitMix64::new(0);
    let mut one = vec![0.0; squared.len()];
    for _ in 0..RESAMPLES {
        for (at, seeds) in squared.iter().enumerate() {
            let many = seeds.len() as u64;
            let draws = (0..many).map(|_| seeds[((u128::from(random.bits()) * u128::from(many)) >> 64) as usize]);
            one[at] = root_mean(draws, seeds.len());
            again[at].push(one[at]);
        }
        slopes.extend(self::slope(samples, &one));
    }
    let errors = errors.iter().zip(&mut again).map(|(error, again)| interval(*error, again)).collect();
    Fitted { errors, slope: slope.map(|s| interval(s, &mut slopes)) }
}

/// Root of a mean square; 0 if subtracting the noise of the reference left a negative value.
fn root_mean(squares: impl Iterator<Item = f64>, many: usize) -> f64 {
    (squares.sum::<f64>() / many.max(1) as f64).max(0.0).sqrt()
}

/// Returns a value with the middle 95 % of its resampled values.
fn interval(value: f64, again: &mut [f64]) -> Interval {
    again.sort_by(f64::total_cmp);
    let at = |share: f64| again.get((share * (again.len().saturating_sub(1)) as f64).round() as usize);
    let (low, high) = (at(0.025).copied().unwrap_or(value), at(0.975).copied().unwrap_or(value));
    Interval { value, low: low.min(value), high: high.max(value) }
}

/// Fits log error against log samples by least squares; `None` if fewer than two errors are above rounding.
fn slope(samples: &[u32], errors: &[f64]) -> Option<f64> {
    let points: Vec<(f64, f64)> = samples
        .iter()
        .zip(errors)
        .filter(|(_, e)| **e > ROUNDING)
        .map(|(n, e)| (libm::log(f64::from(*n)), libm::log(*e)))
        .collect();
    let many = points.len() as f64;
    let (mx, my) = (points.iter().map(|p| p.0).sum::<f64>() / many, points.iter().map(|p| p.1).sum::<f64>() / many);
    let spread: f64 = points.iter().map(|p| (p.0 - mx) * (p.0 - mx)).sum();
    let both: f64 = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
    (points.len() >= 2 && spread > 0.0).then(|| both / spread)
}

/// Mean, and variance of the mean estimated from the scatter of the values.
pub(crate) fn mean_and_variance_of_mean(values: &[f64]) -> (f64, f64) {
    let many = values.len() as f64;
    let mean = values.iter().sum::<f64>() / many;
    let scatter: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    (mean, scatter / (many * (many - 1.0).max(1.0)))
}

/// A relative deviation in standard errors; deviations due to rounding count as nearly zero.
pub(crate) fn in_standard_errors(relative: f64, variance: f64) -> f64 {
    relative / variance.sqrt().max(ROUNDING)
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::numbers::Numbers;

    #[test]
    fn slopes_of_power_laws_are_exact() {
        let samples = [1, 4, 16, 64];
        for power in [-0.5, -1.0, -1.5] {
            let errors = samples.map(|n| 0.3 * libm::pow(f64::from(n), power));
            assert!((slope(&samples, &errors).unwrap() - power).abs() < 1e-12);
        }
        assert_eq!(slope(&samples, &[0.1, 0.0, 0.0, 1e-15]), None);
    }

    /// The interval of a root mean square includes the truth in about 95 of 100 cases. For 40 seeds of one normal variate a percentile
    /// bootstrap is known to fall short by a few.
    #[test]
    fn intervals_hold_the_truth() {
        let mut held = 0;
        for trial in 0..400 {
            // Approximate a normal variate by the sum of twelve uniform ones: mean 6, variance 1.
            let squares: Vec<f64> = (0..40)
                .map(|i| (0..12).map(|d| Numbers::random(3).one(trial, i, d)).sum::<f64>() - 6.0)
                .map(|v| v * v)
                .collect();
            let error = fit(&[1], &[squares]).errors[0];
            held += u32::from(error.low <= 1.0 && 1.0 <= error.high);
        }
        assert!((355..=392).contains(&held), "{held} of 400");
    }

    #[test]
    fn variance_of_the_mean_is_that_of_the_textbook() {
        let (mean, variance) = mean_and_variance_of_mean(&[1.0, 2.0, 3.0, 4.0]);
        assert!((mean - 2.5).abs() < 1e-15 && (variance - 5.0 / 12.0).abs() < 1e-15);
    }
}
