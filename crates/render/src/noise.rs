//! How a picture's noise is stated, and the rounds of samples after which it is measured.
//!
//! A round ends after 32, 40, 48, ..., 128, 144, 160, ... samples of a half. Only then is it decided which tiles go on, so that a render
//! that was stopped decides as one without a stop. `block_noise.rs` measures the noise.

/// Samples of a half after which it is first decided where to go on. Later rounds add a quarter to an eighth of the samples so far.
const FIRST_ROUND: u64 = 32;
/// Smallest number of samples of a half in a round.
const LEAST_ROUND: u64 = 8;

/// The noise of a picture: the standard deviation of a pixel divided by the mean around it, of luminance or of the worst layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// The noise that was requested.
    pub asked: f64,
    /// Noise of the frame's median block.
    pub median: f64,
    /// The noise that 95 % of all blocks stay below.
    pub p95: f64,
    /// Noise of the worst block.
    pub worst: f64,
    /// Fraction of the blocks that are no noisier than requested.
    pub clean: f64,
}

/// Returns the sample of a half at which the round that holds sample `done` ends.
pub(crate) fn next_round(done: u64) -> u64 {
    let mut end = FIRST_ROUND;
    while end <= done {
        // 32, 40, 48, ... 120, 128, 144, 160, ...
        end += ((1 << end.ilog2()) / 8).max(LEAST_ROUND);
    }
    end
}

/// Whether a round ends after this many samples of a half.
pub(crate) fn ends_round(done: u64) -> bool {
    done > 0 && next_round(done - 1) == done
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_grow_by_a_quarter_and_then_an_eighth_at_most() {
        let mut done = 0;
        let ends: Vec<u64> = std::iter::from_fn(|| {
            done = next_round(done);
            Some(done)
        })
        .take(16)
        .collect();
        assert_eq!(ends, [32, 40, 48, 56, 64, 72, 80, 88, 96, 104, 112, 120, 128, 144, 160, 176]);
        assert!(ends.iter().all(|end| ends_round(*end)) && !ends_round(0) && !ends_round(33) && !ends_round(136));
        assert_eq!((next_round(33), next_round(500)), (40, 512));
    }
}
