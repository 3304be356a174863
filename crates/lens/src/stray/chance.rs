//! Numbers of one walk.

use spectra_core::numbers::mix64;

const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// Independent numbers in [0, 1): the k-th of a walk is a pure function of (seed, walk, k).
#[derive(Clone, Debug)]
pub struct Chance {
    key: u64,
    drawn: u64,
}

impl Chance {
    /// Of a walk.
    #[must_use]
    pub fn new(seed: u64, walk: u64) -> Self {
        Self {
            key: mix64(mix64(seed.wrapping_add(GOLDEN)) ^ mix64(walk.wrapping_mul(GOLDEN)).rotate_left(32)),
            drawn: 0,
        }
    }

    /// The next one.
    pub fn number(&mut self) -> f64 {
        self.drawn += 1;
        (mix64(self.key.wrapping_add(self.drawn.wrapping_mul(GOLDEN))) >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }
}
