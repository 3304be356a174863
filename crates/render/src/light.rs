//! The sums of a render so far.

use crate::done::Done;
use crate::sums::ExactSums;
use spectra_core::LossCounts;

/// The light of a scene so far: the sums of each of its estimators, and the rays lost along the way.
pub struct Light {
    pub(crate) parts: Vec<EstimatorSums>,
    pub(crate) losses: LossCounts,
    /// What the meters see, once measured: see [`crate::Estimator::metered`].
    pub(crate) metered: Option<Vec<Vec<f64>>>,
    /// Number of samples at the last decision where to go on.
    pub(crate) judged: u64,
    /// Whether the first pass over the frame is complete.
    pub(crate) covers_frame: bool,
}

/// The sums and counters of one part of a render.
pub(crate) struct EstimatorSums {
    pub sums: ExactSums,
    /// Number of parts that the samples of this kind of light are divided among.
    pub share: u64,
    pub done: Done,
    pub rays: u64,
    /// Number of these rays that brought light to the imager.
    pub detected: u64,
}

impl Light {
    /// Returns the number of samples of each pixel that are in the sums: with several estimators, the smallest number.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.parts.iter().map(|part| part.share * part.done.complete()).min().unwrap_or(0)
    }

    /// Returns whether the first pass over the frame is complete, so that every pixel has light of each kind.
    #[must_use]
    pub fn covers_frame(&self) -> bool {
        self.covers_frame
    }

    /// Returns the number of rays launched for this light.
    #[must_use]
    pub fn rays(&self) -> u64 {
        self.parts.iter().map(|part| part.rays).sum()
    }

    /// Returns the number of launched rays that brought light to the imager.
    #[must_use]
    pub fn detected(&self) -> u64 {
        self.parts.iter().map(|part| part.detected).sum()
    }
}
