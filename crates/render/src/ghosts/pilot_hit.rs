//! Rays of the pilot that came through.

use super::guide::Aim;

/// The contribution of a ray: the sum over all channels, and over those in which noise is measured.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contribution {
    pub all: f64,
    pub judged: f64,
}

impl Contribution {
    pub fn all(&self) -> f64 {
        self.all
    }

    pub fn judged(&self) -> f64 {
        self.judged
    }

    pub fn times(self, factor: f64) -> Self {
        Self { all: self.all * factor, judged: self.judged * factor }
    }
}

/// A ray of the pilot that came through to the frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct PilotHit {
    pub zone: usize,
    pub aim: Aim,
    /// The block of pixels that the ray reached.
    pub block: usize,
    /// Contribution of the ray, not yet divided by the density of its aim.
    pub brought: Contribution,
}

/// Iterates over the rays: the block of each, and its contribution to the light as one of `rays` rays.
pub(super) fn light(seen: &[PilotHit], rays: f64, of: fn(&Contribution) -> f64) -> impl Iterator<Item = (usize, f64)> {
    seen.iter().map(move |seen| (seen.block, of(&seen.brought) / (seen.aim.density * rays)))
}
