//! One way to estimate the exposure.

use crate::pipeline::ThreadState;
use crate::sums::ExactSums;
use crate::{Done, RenderError, Workers};
use std::ops::Range;

/// A way to estimate the exposure, or a part of it: those of one scene add.
///
/// Samples are numbered from 0; a span of them is cut into units of work, each a pure function of the scene, the seed, the
/// span and its own number. Units may run in any order on any thread: their results are added as integers.
pub trait Estimator: Send + Sync {
    /// What it is called: `forward`, `backward`.
    fn name(&self) -> &'static str;

    /// Parts of the frame that may have samples of their own number; 1 where light lands anywhere.
    fn tiles(&self) -> usize;

    /// Paths of ghosts whose light it sums once more, each by itself: as many sums again behind those of all of its light, in this
    /// order. The surfaces of each, counted from 1.
    fn paths(&self) -> &[Vec<usize>] {
        &[]
    }

    /// The tile of a pixel.
    fn tile_of(&self, pixel: usize) -> usize;

    /// A copy that draws its samples from the numbers of `seed`, for the picture of another seed. What was searched and decided
    /// before the first ray is shared.
    fn reseeded(&self, picture: u64, seed: u64) -> Box<dyn Estimator>;

    /// Into how many units a span of samples of these tiles is cut.
    fn units(&self, samples: &Range<u64>, tiles: &[u32]) -> u64;

    /// Rays that a span of samples of these tiles launches.
    fn rays(&self, samples: &Range<u64>, tiles: &[u32]) -> u64;

    /// The columns that one thread works in.
    fn scratch(&self) -> Scratch;

    /// Does one unit of a span of samples of these tiles.
    fn run(&self, samples: &Range<u64>, tiles: &[u32], unit: u64, scratch: &mut Scratch, sums: &ExactSums) -> Unit;

    /// The noise that a pixel of its light is expected to have after so many samples, as a part of that light, in the median over the frame;
    /// `None` of an estimator that does not look.
    fn expected_noise(&self, _samples: u64) -> Option<f64> {
        None
    }

    /// What one unit of each pixel's sums is worth, in W/m2 times the exposure time. `rays` were launched in all.
    fn weights(&self, done: &Done, rays: u64, time_s: f64) -> Vec<f64>;

    /// What the camera's meters see, found with rays of their own by the same way: for each of the scene's meter channels,
    /// W/m2 at each pixel, 0 where no meter looks. Empty where they see nothing of the source.
    ///
    /// # Errors
    /// As [`Estimator::run`].
    fn metered(&self, workers: &dyn Workers) -> Result<Vec<Vec<f64>>, RenderError>;
}

/// What came of a unit.
#[derive(Debug)]
pub struct Unit {
    /// Rays whose light is in the sums.
    pub rays: u64,
    /// Why these are not all of the unit's.
    pub error: Option<RenderError>,
}

/// The columns of one thread, what it counted in them, and what it summed and has not yet added to the sums of all.
pub struct Scratch(pub(crate) ThreadState);
