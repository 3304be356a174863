//! Traces a few thousand rays before all others: to see how bright the brightest are, and whether a stage is broken.

use crate::RenderError;
use crate::finite_check::FiniteCheck;
use crate::non_finite::Step;
use crate::pipeline::{Pipeline, ThreadState};
use crate::sums::{PILOT_RAYS, scale_for};
use spectra_core::RayBatch;

/// Seed of the pilot. The scale of the sums must not depend on the seed of the render, so that renders of the same scene with other seeds
/// can be added.
pub(crate) const PILOT_SEED: u64 = 0x5ca1e;
/// Number of batches without light after which a scene is taken to be dark.
const PILOT_BATCHES: u32 = 64;

/// Finds the scale of the sums from the largest contribution in the first batch that has any light. `trace` traces a batch by its number
/// and passes the rays to its last argument after each step.
pub(crate) fn scale(
    pipeline: &Pipeline,
    trace: impl Fn(&mut ThreadState, u32, &mut dyn FnMut(Step, &RayBatch)),
) -> Result<f64, RenderError> {
    let mut state = ThreadState::new(pipeline, PILOT_RAYS as usize);
    for batch in 0..PILOT_BATCHES {
        let mut blame = FiniteCheck::default();
        trace(&mut state, batch, &mut |step, rays| blame.look(step, rays));
        // This shows a broken stage before any light is traced, if a few thousand rays are enough to find it.
        if let Some(error) = blame.no_number(pipeline) {
            return Err(error);
        }
        let largest = state.largest(pipeline);
        if largest > 0.0 {
            return Ok(scale_for(largest * pipeline.source().peak_over_mean().max(1.0)));
        }
    }
    Ok(scale_for(0.0))
}
