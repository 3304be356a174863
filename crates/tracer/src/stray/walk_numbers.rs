//! The random numbers of one walk.

use spectra_core::numbers::{GOLDEN, SplitMix64, mix64};

/// A stream of independent random numbers in [0, 1): the k-th number of a walk is a pure function of (seed, walk, k).
#[derive(Clone, Debug)]
pub struct WalkNumbers(SplitMix64);

impl WalkNumbers {
    /// Creates the stream of random numbers for walk number `walk`.
    #[must_use]
    pub fn new(seed: u64, walk: u64) -> Self {
        Self(SplitMix64::new(mix64(
            mix64(seed.wrapping_add(GOLDEN)) ^ mix64(walk.wrapping_mul(GOLDEN)).rotate_left(32),
        )))
    }

    /// Returns the next number, in [0, 1).
    pub fn number(&mut self) -> f64 {
        self.0.unit()
    }
}
