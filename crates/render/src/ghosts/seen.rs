//! A ray of the pilot that came through.

use super::guide::Aim;

/// What a ray brought: the sum of all channels, and of those that noise is asked of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Brought {
    pub all: f64,
    pub judged: f64,
}

impl Brought {
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

/// A ray that came through.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub zone: usize,
    pub aim: Aim,
    /// The block that it reached.
    pub block: usize,
    /// But for the density of its aim.
    pub brought: Brought,
}

/// Of each ray the block, and what of the light it is, of so many rays.
pub(super) fn light(seen: &[Seen], rays: f64, of: fn(&Brought) -> f64) -> impl Iterator<Item = (usize, f64)> {
    seen.iter().map(move |seen| (seen.block, of(&seen.brought) / (seen.aim.density * rays)))
}
