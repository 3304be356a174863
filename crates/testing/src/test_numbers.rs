//! Pseudorandom numbers for tests, the same in every run.

use spectra_core::Isa;
use spectra_core::numbers::Numbers;

/// Independent numbers in [0, 1) in each of several dimensions.
pub(crate) struct TestNumbers(Numbers);

impl TestNumbers {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Numbers::random(seed))
    }

    /// Returns number `i` of a dimension.
    pub(crate) fn at(&self, i: usize, dimension: u32) -> f64 {
        self.0.one(0, i as u64, dimension)
    }

    /// Returns number `i` of a dimension, scaled to lie between `low` and `high`.
    pub(crate) fn between(&self, i: usize, dimension: u32, low: f64, high: f64) -> f64 {
        low + (high - low) * self.at(i, dimension)
    }

    /// Returns the first `many` numbers of a dimension.
    pub(crate) fn column(&self, many: usize, dimension: u32) -> Vec<f64> {
        let mut out = vec![0.0; many];
        self.0.fill(Isa::Baseline, 0, 0, dimension, &mut out);
        out
    }
}

/// Returns the mean of values and its standard error.
pub(crate) fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let many = values.len() as f64;
    let mean = values.iter().sum::<f64>() / many;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (many - 1.0);
    (mean, (variance / many).sqrt())
}
