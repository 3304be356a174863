//! The interface of the ways to estimate the exposure.

use crate::pipeline::ThreadState;
use crate::sums::ExactSums;
use crate::{Done, RenderError, Workers};
use spectra_scene::{LightKind, Scene};
use std::ops::Range;
use std::sync::Arc;

/// A way to estimate the exposure or a part of it. The light of all estimators of a scene is added up.
///
/// Samples are numbered from 0. A span of samples is divided into units of work, each a pure function of the scene, the seed, the span and
/// the number of the unit. Units may run in any order on any thread, because their results are added as integers.
///
/// An estimator that adds a constant, such as the fog of a light leak, traces no rays and needs one unit:
///
/// ```
/// use spectra_render::{Done, Estimator, ExactSums, RenderError, Scratch, UnitResult, Workers};
/// use spectra_scene::{LightKind, Scene};
/// use std::ops::Range;
/// use std::sync::Arc;
///
/// /// Fog with the same irradiance in every pixel and channel.
/// #[derive(Clone)]
/// struct Fog {
///     pixels: usize,
///     channels: usize,
///     w_m2: f64,
/// }
///
/// impl Estimator for Fog {
///     fn name(&self) -> &'static str {
///         "fog"
///     }
///     fn light(&self) -> LightKind {
///         LightKind::Glare
///     }
///     fn tiles(&self) -> usize {
///         1
///     }
///     fn tile_of(&self, _pixel: usize) -> usize {
///         0
///     }
///     fn reseeded(&self, _picture: &Arc<Scene>, _seed: u64) -> Box<dyn Estimator> {
///         Box::new(self.clone())
///     }
///     fn units(&self, _samples: &Range<u64>, tiles: &[u32]) -> u64 {
///         tiles.len() as u64
///     }
///     fn rays(&self, _samples: &Range<u64>, _tiles: &[u32]) -> u64 {
///         0
///     }
///     fn scratch(&self) -> Scratch {
///         Scratch::default()
///     }
///     fn run(&self, samples: &Range<u64>, _: &[u32], _unit: u64, _: &mut Scratch, sums: &ExactSums) -> UnitResult {
///         let count = (samples.end - samples.start) as i64;
///         (0..self.pixels * self.channels).for_each(|cell| sums.add(cell, count));
///         UnitResult { rays: 0, error: None }
///     }
///     fn weights(&self, done: &[&Done], _rays: u64, time_s: f64) -> Vec<f64> {
///         // Each sample has added 1 to each sum.
///         let samples: u64 = done.iter().map(|part| part.samples_of(0)).sum();
///         vec![self.w_m2 * time_s / samples.max(1) as f64; self.pixels]
///     }
///     fn metered(&self, _workers: &dyn Workers) -> Result<Vec<Vec<f64>>, RenderError> {
///         Ok(Vec::new())
///     }
/// }
/// ```
pub trait Estimator: Send + Sync {
    /// Name of the estimator, such as `forward` or `backward`.
    fn name(&self) -> &'static str;

    /// The kind of light that is estimated, for layers of light.
    fn light(&self) -> LightKind;

    /// Number of parts of the frame that may have different numbers of samples; 1 if light may land anywhere.
    fn tiles(&self) -> usize;

    /// Ghost paths whose light is also summed separately, each given by its surfaces, counted from 1. Their sums follow the sums of all the
    /// light, in this order, and each is as large.
    fn paths(&self) -> &[Vec<usize>] {
        &[]
    }

    /// Returns the number of the tile that holds a pixel.
    fn tile_of(&self, pixel: usize) -> usize;

    /// Returns a copy that draws its samples from the random numbers of `seed`, for a picture whose rays differ in the seed only. What was
    /// found and decided before the first ray is shared.
    fn reseeded(&self, picture: &Arc<Scene>, seed: u64) -> Box<dyn Estimator>;

    /// Returns a copy that traces the check pixels alone, one in eight, so that the noise can be judged by a second sequence there. Its sums
    /// are numbered by check pixels, and its tiles are the same. `None` if light may land anywhere: such light is divided into halves.
    fn in_check_pixels(&self) -> Option<Box<dyn Estimator>> {
        None
    }

    /// Returns the number of units that a span of samples of these tiles is divided into.
    fn units(&self, samples: &Range<u64>, tiles: &[u32]) -> u64;

    /// Returns the number of rays that a span of samples of these tiles launches.
    fn rays(&self, samples: &Range<u64>, tiles: &[u32]) -> u64;

    /// Allocates the buffers that one thread works in.
    fn scratch(&self) -> Scratch;

    /// Traces one unit of a span of samples of these tiles and adds its light to `sums`.
    fn run(
        &self,
        samples: &Range<u64>,
        tiles: &[u32],
        unit: u64,
        scratch: &mut Scratch,
        sums: &ExactSums,
    ) -> UnitResult;

    /// Estimates the noise of a pixel after this many samples, as a fraction of the light of this estimator, in the median over the frame.
    /// `None` if the estimator makes no such estimate.
    fn expected_noise(&self, _samples: u64) -> Option<f64> {
        None
    }

    /// Returns the factor for each pixel that turns its integer sums into W/m2 times the exposure time. The sums are those of one part of the
    /// samples, or of two added up: `done` says for each part what is in them. The two are halves, or those of this estimator and of its copy
    /// [in check pixels](Estimator::in_check_pixels). `rays` were launched for all of them.
    fn weights(&self, done: &[&Done], rays: u64, time_s: f64) -> Vec<f64>;

    /// Computes what the camera's meters see, with rays of its own, traced in the same way as those of the picture. Returns W/m2 at each
    /// pixel for each meter channel of the scene, 0 where no meter looks. The list is empty if the meters see none of the source's light.
    ///
    /// # Errors
    /// Fails like [`Estimator::run`].
    fn metered(&self, workers: &dyn Workers) -> Result<Vec<Vec<f64>>, RenderError>;
}

/// The result of one unit of work.
#[derive(Debug)]
pub struct UnitResult {
    /// Number of rays that were launched.
    pub rays: u64,
    /// What is wrong with a ray of the unit, if any is. The light of such rays is left out of the sums; the unit counts as done.
    pub error: Option<RenderError>,
}

/// The buffers of one thread: its rays, what it counted, and what it summed but has not yet added to the shared sums. The default has no
/// room for rays; it is for estimators that trace none, or trace in buffers of their own.
#[derive(Default)]
pub struct Scratch(pub(crate) ThreadState);

impl Scratch {
    /// Adds what the thread has summed on its own to the shared sums.
    pub(crate) fn finish(&mut self, sums: &ExactSums) {
        if let Some(own) = &mut self.0.own {
            own.give(sums);
        }
        if let Some(own) = &mut self.0.steps {
            own.give(sums);
        }
    }
}
