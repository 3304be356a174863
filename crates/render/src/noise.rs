//! How a picture's noise is stated, and the rounds of samples after which it is measured.
//!
//! Rounds end after 16, 24, 32, 48, 64, 96, 128, ... samples of a pixel: Sobol points are evenly spread after 2^k and 3 x 2^k, and hardly
//! better between them. (`biotar-color-negative`, blue layer: 6.0 % after 32 samples, 7.8 after 40, 3.7 after 64 and after 80.) Only at the
//! end of a round is it decided which tiles go on, so that a render that was stopped decides as one without a stop. `block_noise.rs`
//! measures the noise.

/// Samples of a pixel after which it is first decided where to go on.
const FIRST_ROUND: u64 = 16;

/// The noise of a picture: the standard deviation of a pixel divided by the mean around it, of luminance or of the worst layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// The noise that was requested; in the frame's median block, if it follows from the grain of the film.
    pub asked: f64,
    /// Whether the request follows from the grain of a film.
    pub by_grain: bool,
    /// Noise of the frame's median block.
    pub median: f64,
    /// The noise that 95 % of all blocks stay below.
    pub p95: f64,
    /// Noise of the worst block.
    pub worst: f64,
    /// Fraction of the blocks that are no noisier than requested.
    pub clean: f64,
}

/// Returns the sample at which the round that holds sample `done` ends.
pub(crate) fn next_round(done: u64) -> u64 {
    let mut end = FIRST_ROUND;
    while end <= done {
        // Half as many again after a power of two, a third as many again after three times a power of two.
        end += if end.is_power_of_two() { end / 2 } else { end / 3 };
    }
    end
}

/// Whether a round ends after this many samples.
pub(crate) fn ends_round(done: u64) -> bool {
    done > 0 && next_round(done - 1) == done
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_end_where_points_are_evenly_spread() {
        let mut done = 0;
        let ends: Vec<u64> = std::iter::from_fn(|| {
            done = next_round(done);
            Some(done)
        })
        .take(8)
        .collect();
        assert_eq!(ends, [16, 24, 32, 48, 64, 96, 128, 192]);
        assert!(ends.iter().all(|end| ends_round(*end)) && !ends_round(0) && !ends_round(40) && !ends_round(80));
        assert_eq!((next_round(33), next_round(500)), (48, 512));
    }
}
