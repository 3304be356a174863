//! The noise of a picture, and the rounds after which it is judged.

/// Samples of a half, after which it is decided where to go on: then a quarter to an eighth as many again, and so on.
const FIRST_ROUND: u64 = 32;
/// Samples of a half in a round, at least.
const LEAST_ROUND: u64 = 8;

/// The noise of a picture: standard deviation of a pixel over the mean around it, of luminance or of the worst layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// What was asked for.
    pub asked: f64,
    /// Of the middle block of the frame.
    pub median: f64,
    /// Below it lie 95 % of all blocks.
    pub p95: f64,
    /// Of the worst block.
    pub worst: f64,
    /// Part of the blocks that have what was asked for.
    pub clean: f64,
}

/// The end of the round in which sample `done` of a half lies, if it has ended none.
pub(crate) fn next_round(done: u64) -> u64 {
    let mut end = FIRST_ROUND;
    while end <= done {
        // 32, 40, 48, ... 120, 128, 144, 160, ...
        end += ((1 << end.ilog2()) / 8).max(LEAST_ROUND);
    }
    end
}

/// Whether a round ends after so many samples of a half.
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
