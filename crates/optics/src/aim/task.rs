//! The task of a pupil search: the lens, the points, the workers and the effort.

use super::effort::Effort;
use super::nodes::Geometry;
use super::table::Depth;
use spectra_core::workers::Workers;
use spectra_lens::Lens;
use spectra_tracer::Tracer;

/// The task of a pupil search.
pub(super) struct Task<'a> {
    pub lens: &'a Lens,
    pub tracer: &'a Tracer,
    pub geometry: Geometry,
    pub depth: Depth,
    /// Depths of the nodes, ascending: one, or one more than there are zones.
    pub depth_nodes: Vec<f64>,
    /// Largest measure of the angle of any point.
    pub most: f64,
    /// Ends of the wavelength band, nm.
    pub band_nm: [f64; 2],
    pub workers: &'a dyn Workers,
    pub effort: Effort,
}

/// The error of a search whose result is no longer wanted.
pub(super) struct Cancelled;

impl Task<'_> {
    /// Fails if the workers are to stop and the result is no longer wanted.
    pub fn check_cancelled(&self) -> Result<(), Cancelled> {
        if self.workers.should_stop() { Err(Cancelled) } else { Ok(()) }
    }
}
