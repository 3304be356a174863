//! The grain of a film, as an unevenness of the exposure.

/// Standard deviation of a film's grain in one channel, as a fraction of the exposure that would make the same densities without grain. It
/// tells how much noise of the light the grain hides.
#[derive(Clone, Debug, PartialEq)]
pub struct GrainNoise {
    /// Log10 of the exposure (lx s) of the first sample, and the step to the next.
    first_log10: f64,
    step_log10: f64,
    fractions: Vec<f64>,
}

impl GrainNoise {
    /// Creates a table of fractions at equal steps of log10 exposure (lx s), beginning at `first_log10`.
    ///
    /// # Panics
    /// If there is no sample.
    #[must_use]
    pub fn new(first_log10: f64, step_log10: f64, fractions: Vec<f64>) -> Self {
        assert!(!fractions.is_empty(), "a table has samples");
        Self { first_log10, step_log10, fractions }
    }

    /// Returns the standard deviation at an exposure (lx s), as a fraction of it: linear between samples, and that of the nearest sample
    /// beyond them and without exposure.
    #[must_use]
    pub fn at(&self, exposure_lx_s: f64) -> f64 {
        let last = (self.fractions.len() - 1) as f64;
        let place = (crate::math::log10(exposure_lx_s.max(f64::MIN_POSITIVE)) - self.first_log10) / self.step_log10;
        let place = place.clamp(0.0, last);
        let below = self.fractions[place as usize];
        let above = self.fractions[(place as usize + 1).min(self.fractions.len() - 1)];
        below + (above - below) * (place - place.floor())
    }

    /// Returns the smallest standard deviation (lx s) at this exposure (lx s) or at any larger one: what the grain hides however much other
    /// light is added.
    #[must_use]
    pub fn least_deviation_from(&self, exposure_lx_s: f64) -> f64 {
        let sample = |at: usize| crate::math::pow(10.0, self.first_log10 + at as f64 * self.step_log10);
        let larger = (0..self.fractions.len()).map(sample).filter(|sample| *sample > exposure_lx_s);
        larger.map(|sample| sample * self.at(sample)).fold(exposure_lx_s * self.at(exposure_lx_s), f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_are_linear_between_samples_and_held_beyond() {
        let grain = GrainNoise::new(-2.0, 1.0, vec![0.4, 0.2, 0.1]);
        let near = |exposure: f64, fraction: f64| (grain.at(exposure) - fraction).abs() < 1e-12;
        assert!(near(0.01, 0.4) && near(0.1, 0.2) && near(1.0, 0.1));
        // From 0.005 to 0.02 lx s and on to 0.1; a film whose toe is grainier has the least deviation beyond it.
        let toe = GrainNoise::new(-2.0, 1.0, vec![4.0, 0.2, 0.1]);
        let (here, beyond) = (grain.least_deviation_from(0.01), toe.least_deviation_from(0.01));
        assert!((here - 0.004).abs() < 1e-12 && (beyond - 0.02).abs() < 1e-12, "{here} {beyond}");
        assert!(near(10.0_f64.powf(-1.5), 0.3) && near(1e-5, 0.4) && near(0.0, 0.4) && near(1e9, 0.1));
    }
}
