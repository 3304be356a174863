//! The light of a render so far.

use crate::done::Done;
use crate::sums::ExactSums;
use spectra_core::LossCounts;

/// What was summed of a scene, by each of its estimators, and what was lost meanwhile.
pub struct Light {
    pub(crate) parts: Vec<Part>,
    pub(crate) losses: LossCounts,
    /// What the meters see, once they have looked: see [`crate::Estimator::metered`].
    pub(crate) metered: Option<Vec<Vec<f64>>>,
    /// Samples of each half after which it was decided last where to go on.
    pub(crate) judged: u64,
    /// Halves that each sample of a pixel is one of: two where noise is asked for.
    pub(crate) halves: u64,
}

/// The sums of one estimator.
pub(crate) struct Part {
    pub sums: ExactSums,
    pub done: Done,
    pub rays: u64,
    /// Of these, rays that brought light to the imager.
    pub detected: u64,
}

impl Light {
    /// Of each pixel, so many samples are in the sums: of several estimators, the fewest.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.halves * self.parts.iter().map(|part| part.done.complete()).min().unwrap_or(0)
    }

    /// Rays that were launched for it.
    #[must_use]
    pub fn rays(&self) -> u64 {
        self.parts.iter().map(|part| part.rays).sum()
    }

    /// Rays of these that brought light to the imager.
    #[must_use]
    pub fn detected(&self) -> u64 {
        self.parts.iter().map(|part| part.detected).sum()
    }
}
