//! Random numbers that are functions of a seed and of what they are drawn for, so that they do not depend on order.

use spectra_core::math::{cos, log};
use spectra_core::numbers::{GOLDEN, mix64};
use std::f64::consts::TAU;

/// A seed from which the random numbers of one drawn thing follow.
#[derive(Clone, Copy, Debug)]
pub(super) struct RandomSeed(u64);

impl RandomSeed {
    pub(super) fn new(seed: u64, what: &str) -> Self {
        what.bytes().fold(Self(mixed(seed)), |chance, letter| chance.with(u64::from(letter)))
    }

    /// Returns the seed of part `part` of this thing.
    pub(super) fn with(self, part: u64) -> Self {
        Self(mixed(self.0 ^ mixed(part)))
    }

    /// Returns the `which`-th uniform number in (0, 1).
    pub(super) fn uniform(self, which: u64) -> f64 {
        ((self.with(which).0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// Returns the `which`-th uniform number between `low` and `high`.
    pub(super) fn between(self, which: u64, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform(which)
    }

    /// Returns the `which`-th number with the standard normal distribution (G. E. P. Box and M. E. Muller, 1958).
    pub(super) fn normal(self, which: u64) -> f64 {
        (-2.0 * log(self.uniform(2 * which))).sqrt() * cos(TAU * self.uniform(2 * which + 1))
    }
}

/// Mixes the bits of a number; zero does not stay zero.
fn mixed(value: u64) -> u64 {
    mix64(value.wrapping_add(GOLDEN))
}
