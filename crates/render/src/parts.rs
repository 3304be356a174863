//! The parts of a render: its estimators, each with its share of the samples.
//!
//! Without a limit on the noise, each kind of light has one part. With a limit it has two, whose difference tells the noise: light that may
//! land anywhere is divided into two halves with independent random numbers, and light of single pixels is traced a second time in every
//! eighth pixel ([`crate::check_pixels`]).

use crate::check_pixels::CheckPixels;
use crate::estimator::Estimator;
use crate::light::{EstimatorSums, Light};
use spectra_core::numbers::mix64;
use spectra_scene::Scene;
use std::sync::Arc;

/// The samples of its kind of light that a part traces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// All samples.
    All,
    /// Half of the samples.
    Half,
    /// Every sample once more, in the check pixels.
    Check,
}

/// An estimator and its share of the samples.
pub(crate) struct Part {
    pub estimator: Box<dyn Estimator>,
    pub role: Role,
}

impl Part {
    /// Number of parts that the samples of this kind of light are divided among.
    pub fn share(&self) -> u64 {
        if self.role == Role::Half { 2 } else { 1 }
    }
}

/// All parts of a render: the first part of each kind of light, then the second of each if there are two.
pub(crate) struct Parts {
    pub all: Vec<Part>,
    /// Number of kinds of light.
    pub kinds: usize,
    pub checks: CheckPixels,
}

impl Parts {
    /// Makes the parts of a scene from its estimators, one for each kind of light.
    pub fn new(scene: &Arc<Scene>, estimators: Vec<Box<dyn Estimator>>) -> Self {
        let (kinds, checks) = (estimators.len(), CheckPixels::of(scene.imager.size(), scene.render.seed));
        if scene.render.noise.is_none() {
            let all = estimators.into_iter().map(|estimator| Part { estimator, role: Role::All }).collect();
            return Self { all, kinds, checks };
        }
        let seed = scene.render.seed;
        let second = |estimator: &dyn Estimator| match estimator.in_check_pixels() {
            Some(check) => Part { estimator: check.reseeded(scene, seed_of(seed, Role::Check, 1)), role: Role::Check },
            None => Part { estimator: estimator.reseeded(scene, seed_of(seed, Role::Half, 1)), role: Role::Half },
        };
        let seconds: Vec<Part> = estimators.iter().map(|estimator| second(&**estimator)).collect();
        let first = |(estimator, second): (Box<dyn Estimator>, &Part)| match second.role {
            Role::Half => Part { estimator: estimator.reseeded(scene, seed_of(seed, Role::Half, 0)), role: Role::Half },
            _ => Part { estimator, role: Role::All },
        };
        let firsts: Vec<Part> = estimators.into_iter().zip(&seconds).map(first).collect();
        Self { all: firsts.into_iter().chain(seconds).collect(), kinds, checks }
    }

    /// Returns the same parts for a picture whose rays differ in the seed only.
    pub fn of_picture(&self, picture: &Arc<Scene>) -> Self {
        let seed = picture.render.seed;
        let reseed = |(at, part): (usize, &Part)| {
            let own = seed_of(seed, part.role, (at / self.kinds) as u64);
            Part { estimator: part.estimator.reseeded(picture, own), role: part.role }
        };
        let all = self.all.iter().enumerate().map(reseed).collect();
        Self { all, kinds: self.kinds, checks: CheckPixels::of(picture.imager.size(), seed) }
    }

    /// The first part of each kind of light.
    pub fn firsts(&self) -> &[Part] {
        &self.all[..self.kinds]
    }

    /// The estimators of all parts.
    pub fn estimators(&self) -> impl Iterator<Item = &dyn Estimator> {
        self.all.iter().map(|part| &*part.estimator)
    }

    /// Returns the parts of one kind of light, each with its sums.
    pub fn of_kind<'a>(&'a self, kind: usize, light: &'a Light) -> impl Iterator<Item = (&'a Part, &'a EstimatorSums)> {
        self.all.iter().zip(&light.parts).skip(kind).step_by(self.kinds)
    }

    /// Returns the number of the pixel within the sums of a part; `None` if the part does not trace it.
    pub fn place(&self, part: &Part, pixel: usize) -> Option<usize> {
        if part.role == Role::Check { self.checks.group_of(pixel) } else { Some(pixel) }
    }
}

/// Returns the seed of the random numbers of a part, which is the `at`-th of its kind of light.
fn seed_of(seed: u64, role: Role, at: u64) -> u64 {
    if role == Role::All { seed } else { mix64(seed ^ mix64(at + 1)) }
}
