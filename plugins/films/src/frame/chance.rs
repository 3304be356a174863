//! Numbers that follow from what they are for.

use spectra_core::math::{cos, log};
use std::f64::consts::TAU;

/// A seed of its own for each thing that is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chance(u64);

impl Chance {
    pub(super) fn new(seed: u64, what: &str) -> Self {
        what.bytes().fold(Self(mixed(seed)), |chance, letter| chance.with(u64::from(letter)))
    }

    /// That of a part of it.
    pub(super) fn with(self, part: u64) -> Self {
        Self(mixed(self.0 ^ mixed(part)))
    }

    /// A number in (0, 1), the `which`-th.
    pub(super) fn uniform(self, which: u64) -> f64 {
        ((self.with(which).0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// A number between two.
    pub(super) fn between(self, which: u64, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform(which)
    }

    /// A normal number (G. E. P. Box and M. E. Muller, 1958).
    pub(super) fn normal(self, which: u64) -> f64 {
        (-2.0 * log(self.uniform(2 * which))).sqrt() * cos(TAU * self.uniform(2 * which + 1))
    }
}

/// S. Vigna's mixer of splitmix64 (D. Stafford's thirteenth), public domain.
fn mixed(value: u64) -> u64 {
    let z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
