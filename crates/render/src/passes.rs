//! The passes over the frame in which a picture is traced.
//!
//! A pass gives every estimator the same fraction of its samples, all over the frame. The first two passes have one sample of each half, and
//! each later pass has as many as all passes before it. A render that is stopped after the first pass is therefore the whole frame, with
//! more noise, and no part of it has less than half of the samples of another. Sums do not depend on where passes end.
//!
//! A sample of lights has about twelve rays for each pixel that they reach, much more than the one ray of a backward sample. Of light that
//! may land anywhere, the first pass therefore takes an eighth of a sample, which is about as noisy; the next pass completes it.

use crate::estimator::Estimator;

/// Returns the sample at which the pass ends that begins at sample `done`.
pub(crate) fn next_pass(done: u64) -> u64 {
    if done == 0 { 1 } else { done.saturating_mul(2) }
}

/// One part in this many of its first sample is traced in the first pass by an estimator whose light may land anywhere.
const FIRST_PARTS: u64 = 8;

/// Returns the number of units of the first pass, for an estimator with this many units in its first sample.
pub(crate) fn first_units(estimator: &dyn Estimator, units: u64) -> u64 {
    if estimator.tiles() == 1 { units.div_ceil(FIRST_PARTS) } else { units }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_double() {
        let ends: Vec<u64> = std::iter::successors(Some(0), |done| Some(next_pass(*done))).take(7).collect();
        assert_eq!(ends, [0, 1, 2, 4, 8, 16, 32]);
    }
}
