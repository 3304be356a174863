//! The footprints of ghosts: as wide as their noise wants them, no wider than each path's net allows.

use super::probes::{self, Found};
use super::width::{self, Width};
use super::{Ghosts, Landed};
use crate::Workers;
use crate::error::RenderError;
use crate::footprint::Footprint;
use crate::pipeline::ThreadState;
use crate::spreader::Spreader;
use crate::sums::ExactSums;

/// What spreading ghosts needs, found once for a scene.
#[derive(Clone, Debug)]
pub(super) struct Spreading {
    pub spreader: Spreader,
    pub width: Width,
    /// Of each path by the zones of the source.
    nets: Vec<Vec<Found>>,
}

impl Spreading {
    /// For ghosts whose rays are shared out already; `None` where there is nothing to spread.
    pub fn of(ghosts: &Ghosts, workers: &dyn Workers) -> Result<Option<Self>, RenderError> {
        let width = width::found(ghosts, workers)?;
        if width.is_none() {
            return Ok(None);
        }
        let nets = probes::nets(ghosts, workers)?;
        Ok(Some(Self { spreader: Spreader::of(&ghosts.pipeline), width, nets }))
    }

    /// Adds what the rays of a batch of a path bring, in a sample of this number, to the cells of all paths and to those that begin with
    /// `own_cells`.
    pub fn add(
        &self,
        state: &mut ThreadState,
        (at, sample): (usize, u64),
        landed: &[Landed],
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
