//! Measures ghosts as a camera's meter sees them: traces some blocks with separate random numbers.

use super::{Ghosts, PathPlan, Plan};
use crate::Workers;
use crate::error::RenderError;
use crate::meter;
use crate::pipeline::ThreadState;
use crate::sums::ExactSums;
use spectra_core::workers::map_pieces;
use std::sync::Arc;

impl Ghosts {
    /// Returns a copy that traces what the meters see; `None` if they see none of the source's light.
    pub(super) fn of_meters(&self, workers: &dyn Workers) -> Option<Result<Self, RenderError>> {
        let pipeline = Arc::new(self.pipeline.of_meters()?);
        let numbers = self.of_seed(pipeline.seed ^ meter::SEED);
        // Meters see means, which footprints do not change.
        let own = Self { pipeline, plan: Arc::new(self.plan.together()), spreading: None, numbers, scale: 1.0 };
        Some(own.pilot_scale(workers).map(|scale| Self { scale, ..own }))
    }

    /// Measures the light, W/m2 at each pixel, channel by channel.
    pub(super) fn meter(&self, workers: &dyn Workers) -> Result<Vec<Vec<f64>>, RenderError> {
        let pipeline = &self.pipeline;
        let scene = &pipeline.scene;
        let (pixels, channels) = (scene.imager.size().pixels(), pipeline.responses.channels());
        if scene.metered_pixels().is_empty() {
            return Ok(vec![vec![0.0; pixels]; channels]);
        }
        // A block represents all paths fairly, however many rays it has.
        let blocks = meter::rays_for(pixels, pipeline.effort).div_ceil(self.plan.rays);
        let sums = ExactSums::new(pixels * channels).ok_or_else(|| RenderError::Memory(crate::memory_needed(scene)))?;
        let work = |state: &mut ThreadState, block: usize| {
            if workers.should_stop() {
                return Err(RenderError::Stopped);
            }
            self.block(state, block as u64, &sums).error.map_or(Ok(()), Err)
        };
        map_pieces(workers, blocks as usize, || self.state(scene.render.batch), work)?;
        let weight = self.worth(blocks * self.plan.rays, 1.0);
        Ok(meter::planes(&sums, channels, |_| weight, pixels))
    }
}

impl Plan {
    /// Returns the plan without separate sums for some paths.
    fn together(&self) -> Self {
        let way = |way: &PathPlan| PathPlan { own_cells: None, ..way.clone() };
        Self { ways: self.ways.iter().map(way).collect(), apart: Vec::new(), ..self.clone() }
    }
}
