//! Functions sampled at equal steps.

/// Interpolates linearly between samples at `place`, counted in steps from the first sample. There must be at least two
/// samples, and 0 <= `place` <= number of samples - 1.
#[inline(always)]
#[must_use]
pub fn linear(samples: &[f64], place: f64) -> f64 {
    let i = (place as usize).min(samples.len() - 2);
    let (a, b) = (samples[i], samples[i + 1]);
    a + (b - a) * (place - i as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_met_and_joined_by_lines() {
        let samples = [1.0, 3.0, -2.0];
        for (place, want) in [(0.0, 1.0), (0.25, 1.5), (1.0, 3.0), (1.5, 0.5), (2.0, -2.0)] {
            assert_eq!(linear(&samples, place), want, "{place}");
        }
    }
}
