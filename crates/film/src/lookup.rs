//! Smooth functions, sampled once and looked up for every pixel of a frame.

use rayon::prelude::*;
use spectra_numerics::table;

/// Number of pixels per parallel task.
pub(crate) const PIXELS_A_TASK: usize = 8192;

/// A function sampled at equal steps, linear between the samples, constant beyond them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Lookup {
    low: f64,
    per_step: f64,
    values: Vec<f64>,
}

impl Lookup {
    /// Samples `f` at both ends and at `steps - 1` places between.
    pub(crate) fn new(low: f64, high: f64, steps: usize, f: impl Fn(f64) -> f64 + Sync) -> Self {
        let width = (high - low) / steps as f64;
        let values = (0..steps + 1).into_par_iter().with_min_len(1024).map(|i| f(low + width * i as f64)).collect();
        Self { low, per_step: 1.0 / width, values }
    }

    /// Builds the table from values at equal steps from `low` to `high`; at least two.
    pub(crate) fn from_values(low: f64, high: f64, values: Vec<f64>) -> Self {
        Self { low, per_step: (values.len() - 1) as f64 / (high - low), values }
    }

    /// Smallest and largest value of the table.
    pub(crate) fn extremes(&self) -> (f64, f64) {
        let fold = |start: f64, f: fn(f64, f64) -> f64| self.values.iter().copied().fold(start, f);
        (fold(f64::INFINITY, f64::min), fold(f64::NEG_INFINITY, f64::max))
    }

    /// Interpolates the function at `x`; NaN is taken as the low end.
    #[inline(always)]
    pub(crate) fn at(&self, x: f64) -> f64 {
        let last = self.values.len() - 1;
        let p = ((x - self.low) * self.per_step).max(0.0).min(last as f64);
        table::linear(&self.values, p)
    }
}

/// Two functions sampled at the same places and stored side by side.
#[derive(Clone, Debug)]
pub(crate) struct Pair {
    low: f64,
    per_step: f64,
    values: Vec<[f64; 2]>,
}

impl Pair {
    /// Joins two functions that are sampled at the same places.
    pub(crate) fn new(first: &Lookup, second: &Lookup) -> Self {
        assert_eq!((first.low, first.per_step), (second.low, second.per_step), "the places are the same");
        let values = first.values.iter().zip(&second.values).map(|(a, b)| [*a, *b]).collect();
        Self { low: first.low, per_step: first.per_step, values }
    }

    /// Interpolates both functions at `x` as [`Lookup::at`] does.
    #[inline(always)]
    pub(crate) fn at(&self, x: f64) -> [f64; 2] {
        let last = self.values.len() - 1;
        let p = ((x - self.low) * self.per_step).max(0.0).min(last as f64);
        let i = (p as i32 as usize).min(last - 1);
        let (a, b, t) = (self.values[i], self.values[i + 1], p - i as f64);
        [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t]
    }
}

/// Approximate log2 of a positive number relative to the smallest normal `f32`: exact at powers of 2 and linear between them. It is cheap
/// and has an exact inverse.
#[inline(always)]
pub(crate) fn octaves(value: f32) -> f64 {
    f64::from(value.to_bits()) * (1.0 / 8_388_608.0) - 1.0
}

/// Inverse of [`octaves`], for values of at least 0.
pub(crate) fn from_octaves(octaves: f64) -> f64 {
    let whole = octaves.floor();
    // 2^-126 is the smallest normal number; a double can hold all of its octaves.
    (1.0 + (octaves - whole)) * f64::from_bits(((whole as u64) + 1023 - 126) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn octaves_and_back() {
        for value in [f32::MIN_POSITIVE, 1e-12, 0.01, 0.125, 1.0, 1.5, 1.999_999_9, 3.7e5, f32::MAX] {
            assert_eq!(from_octaves(octaves(value)), f64::from(value), "{value}");
        }
        assert_eq!(octaves(1.0), 126.0);
        assert_eq!(octaves(1.5), 126.5);
    }

    #[test]
    fn linear_between_samples_and_held_beyond() {
        let square = Lookup::new(-1.0, 3.0, 4, |x| x * x);
        for (x, want) in [(-1.0, 1.0), (0.0, 0.0), (0.5, 0.5), (2.5, 6.5), (3.0, 9.0), (7.0, 9.0), (-5.0, 1.0)] {
            assert!((square.at(x) - want).abs() < 1e-14, "{x}");
        }
        assert_eq!(square.at(f64::NAN), 1.0);
        assert_eq!(square.at(f64::INFINITY), 9.0);
    }
}
