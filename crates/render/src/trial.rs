//! A trial before light is traced: how bright the frame is, from 64 of its tiles with 16 samples. It draws from the random numbers of the
//! pilot, so every seed of the picture finds the same.

use crate::estimator::Estimator;
use crate::memory::memory_needed;
use crate::pilot::PILOT_SEED;
use crate::pipeline::Pipeline;
use crate::sums::ExactSums;
use crate::{Done, RenderError};
use spectra_scene::Scene;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Tiles of the frame whose median stands for that of the frame.
const TILES: usize = 64;
/// Samples of each pixel of these tiles.
const SAMPLES: u64 = 16;

/// Returns the scene with the seed of the pilot.
pub(crate) fn of_pilot(pipeline: &Pipeline) -> Arc<Scene> {
    Arc::new(pipeline.scene.with_seed(PILOT_SEED))
}

/// Allocates sums for all the light of one estimator.
pub(crate) fn new_sums(pipeline: &Pipeline) -> Result<ExactSums, RenderError> {
    let cells = pipeline.scene.imager.size().pixels() * pipeline.recorded.len();
    ExactSums::new(cells).ok_or_else(|| RenderError::Memory(memory_needed(&pipeline.scene)))
}

/// Returns the median of the frame in each channel, W/m2, from some of its tiles.
pub(crate) fn medians(pipeline: &Pipeline, rest: &dyn Estimator) -> Result<Vec<f64>, RenderError> {
    let (all, channels) = (rest.tiles(), pipeline.recorded.len());
    let tiles: Vec<u32> = (0..all.min(TILES)).map(|i| (i * all / all.min(TILES)) as u32).collect();
    let (trial, samples) = (rest.reseeded(&of_pilot(pipeline), PILOT_SEED), 0..SAMPLES);
    let (sums, mut scratch) = (new_sums(pipeline)?, trial.scratch());
    for unit in 0..trial.units(&samples, &tiles) {
        trial.run(&samples, &tiles, unit, &mut scratch, &sums);
    }
    let weights = trial.weights(&[&Done::of(SAMPLES, None, BTreeMap::new())], 0, 1.0);
    let pixels: Vec<usize> =
        (0..weights.len()).filter(|pixel| tiles.binary_search(&(trial.tile_of(*pixel) as u32)).is_ok()).collect();
    let median = |channel: usize| {
        let value = |pixel: &usize| sums.get(pixel * channels + channel) as f64 * weights[*pixel];
        let mut values: Vec<f64> = pixels.iter().map(value).collect();
        let middle = values.len() / 2;
        *values.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    Ok((0..channels).map(median).collect())
}
