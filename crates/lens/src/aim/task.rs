//! What is searched, by whom and how finely.

use super::effort::Effort;
use super::nodes::Geometry;
use super::table::Depth;
use crate::{Lens, Tracer};
use spectra_core::workers::Workers;

/// What is searched.
pub(super) struct Task<'a> {
    pub lens: &'a Lens,
    pub tracer: &'a Tracer,
    pub geometry: Geometry,
    pub depth: Depth,
    /// Depths that nodes stand at, in rising order: one, or one more than zones.
    pub depth_nodes: Vec<f64>,
    /// Largest measure of the angle that any point has.
    pub most: f64,
    /// The ends of the band, nm.
    pub band_nm: [f64; 2],
    pub workers: &'a dyn Workers,
    pub effort: Effort,
}

/// Nobody wants the result any more.
pub(super) struct NotWanted;

impl Task<'_> {
    /// Whether somebody still waits for the result.
    pub fn wanted(&self) -> Result<(), NotWanted> {
        if self.workers.should_stop() { Err(NotWanted) } else { Ok(()) }
    }
}
