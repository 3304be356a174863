//! The footprints of ghosts: as wide as their noise requires, and no wider than the net of each path allows.

use super::probes::{self, OrientedGrid};
use super::width::{self, Width};
use super::{Entrance, Ghosts};
use crate::Workers;
use crate::error::RenderError;
use crate::footprint::Footprint;
use crate::footprint_sums::Spreader;
use crate::pipeline::ThreadState;
use crate::sums::ExactSums;

/// The data for spreading ghosts, computed once per scene.
#[derive(Clone, Debug)]
pub(super) struct GhostFootprints {
    pub spreader: Spreader,
    pub width: Width,
    /// Nets of each path for the zones of the source.
    nets: Vec<Vec<OrientedGrid>>,
}

impl GhostFootprints {
    /// Prepares spreading for ghosts whose rays are already shared out; `None` if there is nothing to spread.
    pub fn of(ghosts: &Ghosts, workers: &dyn Workers) -> Result<Option<Self>, RenderError> {
        let width = width::found(ghosts, workers)?;
        if width.is_none() {
            return Ok(None);
        }
        let nets = probes::nets(ghosts, workers)?;
        Ok(Some(Self { spreader: Spreader::of(&ghosts.pipeline), width, nets }))
    }

    /// Adds the contributions of a batch of a path's rays to the cells of all paths, and to the separate cells that begin at `own_cells`.
    /// `sample` is the number of the sample.
    pub fn add(
        &self,
        state: &mut ThreadState,
        (at, sample): (usize, u64),
        landed: &[Entrance],
        own_cells: Option<usize>,
        sums: &ExactSums,
    ) {
        let half = self.width.of_sample(sample).min(self.spreader.most_half);
        let nets = &self.nets[at];
        let footprint = |i: usize| {
            let landed = &landed[i];
            nets.get(landed.zone).map_or(Footprint::PIXEL, |found| found.footprint(landed, half))
        };
        self.spreader.add(state, footprint, own_cells, sums);
    }
}
