//! The index as cubics on a uniform grid of wavelengths, for tabulated data.

use super::largest_error;
use crate::medium::Medium;

/// Largest number of intervals of a table: 1 MiB.
const MOST_INTERVALS: usize = 32_768;

/// Cubics between uniform wavelengths, each through four neighboring samples.
#[derive(Clone, Debug)]
pub(super) struct Sampled {
    min_nm: f64,
    inverse_step_nm: f64,
    last: f64,
    /// Coefficients in ascending order of the power of the fraction of the interval.
    cubics: Box<[[f64; 4]]>,
}

impl Sampled {
    /// Finds the coarsest table, by doubling, that is within `tolerance` of the medium at `checks` and in the middle of every
    /// interval, and its largest error. `None` if the finest table is not that good.
    pub(super) fn fit(
        medium: &Medium,
        min_nm: f64,
        max_nm: f64,
        tolerance: f64,
        checks: &[(f64, f64)],
    ) -> Option<(Sampled, f64)> {
        let mut intervals = 256;
        while intervals <= MOST_INTERVALS {
            let table = Sampled::new(medium, min_nm, max_nm, intervals);
            let step = (max_nm - min_nm) / intervals as f64;
            let middles: Vec<(f64, f64)> =
                (0..intervals).map(|i| min_nm + step * (i as f64 + 0.5)).map(|w| (w, medium.index(w))).collect();
            let error = largest_error(&middles, |w| table.evaluate(w));
            if error <= tolerance {
                let error = error.max(largest_error(checks, |w| table.evaluate(w)));
                if error <= tolerance {
                    return Some((table, error));
                }
            }
            intervals *= 2;
        }
        None
    }

    fn new(medium: &Medium, min_nm: f64, max_nm: f64, intervals: usize) -> Sampled {
        let step = (max_nm - min_nm) / intervals as f64;
        let samples: Vec<f64> = (0..=intervals).map(|i| medium.index(min_nm + step * i as f64)).collect();
        let cubics = (0..intervals)
            .map(|i| {
                // At the ends the four samples are all on one side.
                let first = i.saturating_sub(1).min(intervals - 3);
                let t = |k: usize| (first + k) as f64 - i as f64;
                interpolate(
                    [t(0), t(1), t(2), t(3)],
                    [samples[first], samples[first + 1], samples[first + 2], samples[first + 3]],
                )
            })
            .collect();
        Sampled { min_nm, inverse_step_nm: 1.0 / step, last: (intervals - 1) as f64, cubics }
    }

    #[inline(always)]
    pub(super) fn evaluate(&self, wavelength_nm: f64) -> f64 {
        let position = (wavelength_nm - self.min_nm) * self.inverse_step_nm;
        let interval = position.min(self.last).max(0.0) as usize;
        let t = position - interval as f64;
        let c = &self.cubics[interval];
        c[0] + t * (c[1] + t * (c[2] + t * c[3]))
    }
}

/// Returns the coefficients of the cubic through four points: Newton's divided differences, expanded.
fn interpolate(t: [f64; 4], y: [f64; 4]) -> [f64; 4] {
    let d01 = (y[1] - y[0]) / (t[1] - t[0]);
    let d12 = (y[2] - y[1]) / (t[2] - t[1]);
    let d23 = (y[3] - y[2]) / (t[3] - t[2]);
    let d012 = (d12 - d01) / (t[2] - t[0]);
    let d123 = (d23 - d12) / (t[3] - t[1]);
    let d = (d123 - d012) / (t[3] - t[0]);
    [
        y[0] - t[0] * (d01 - t[1] * (d012 - t[2] * d)),
        d01 - (t[0] + t[1]) * d012 + (t[0] * t[1] + t[0] * t[2] + t[1] * t[2]) * d,
        d012 - (t[0] + t[1] + t[2]) * d,
        d,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_points_of_a_cubic_give_the_cubic() {
        let cubic = |t: f64| 2.0 - t + 0.5 * t * t + 3.0 * t * t * t;
        for first in [-2.0, -1.0, 0.0] {
            let t = [first, first + 1.0, first + 2.0, first + 3.0];
            for (got, expected) in interpolate(t, t.map(cubic)).iter().zip([2.0, -1.0, 0.5, 3.0]) {
                assert!((got - expected).abs() < 1e-13);
            }
        }
    }
}
