//! Probes: rays from one point of each zone of the source, with which the nets of all paths are found.

use super::aims::{Aims, azimuth};
use super::probe_grid::ProbeGrid;
use super::{ESTIMATOR, Entrance, Ghosts, Guide, PathPlan};
use crate::Workers;
use crate::error::RenderError;
use crate::footprint::Footprint;
use crate::pipeline::ThreadState;
use glam::DVec3;
use spectra_core::loss::ALIVE;
use spectra_core::workers::map_pieces;
use spectra_optics::FrontOpening;

/// Number of rays with which the source is sampled.
const POINTS: usize = 2048;
/// Number of rays in a batch.
const BATCH: usize = 256;

/// The starting point of probes and their wavelength.
#[derive(Clone, Copy)]
struct Start {
    point: DVec3,
    nm: f64,
    opening: FrontOpening,
}

/// A net, and the data to rotate it for the rays of a source point elsewhere around the axis.
#[derive(Clone, Debug)]
pub(super) struct OrientedGrid {
    net: ProbeGrid,
    /// Direction around the axis of the point for which the net was found, a unit vector. `None` for a lens without rotational symmetry,
    /// whose net cannot be rotated.
    azimuth: Option<[f64; 2]>,
}

impl OrientedGrid {
    /// Returns the footprint of a ray, with half side `half` where that is allowed.
    pub fn footprint(&self, landed: &Entrance, half: f64) -> Footprint {
        let turn = self.azimuth.map_or([1.0, 0.0], |[x, y]| {
            let [u, v] = landed.azimuth;
            [u * x + v * y, v * x - u * y]
        });
        self.net.footprint(landed.place, half, turn)
    }
}

/// Finds the nets of each path for the zones of the source. There are none for light that sets its directions itself, or for a path whose
/// zones share a guide.
pub(super) fn nets(ghosts: &Ghosts, workers: &dyn Workers) -> Result<Vec<Vec<OrientedGrid>>, RenderError> {
    let ways = &ghosts.plan.ways;
    let Some(opening) = ghosts.plan.opening else { return Ok(vec![Vec::new(); ways.len()]) };
    let starts = starts(ghosts, opening);
    let is_round = ghosts.pipeline.scene.lens.has_axis_of_revolution();
    map_pieces(
        workers,
        ways.len(),
        || ghosts.state(BATCH),
        |state, at| {
            if workers.should_stop() {
                return Err(RenderError::Stopped);
            }
            let way = &ways[at];
            if way.guides.len() != starts.len() {
                return Ok(Vec::new());
            }
            let net = |(guide, start): (&Guide, &Option<Start>)| {
                let net = ProbeGrid::new(guide.part(), |places| match start {
                    Some(start) => landed(ghosts, state, way, *start, places),
                    None => vec![None; places.len()],
                });
                let azimuth = start.filter(|_| is_round).map(|start| azimuth(start.point.x, start.point.y));
                OrientedGrid { net, azimuth }
            };
            Ok(way.guides.iter().zip(&starts).map(net).collect())
        },
    )
}

/// Returns for each zone a point in its middle, with the median of the drawn wavelengths.
fn starts(ghosts: &Ghosts, opening: FrontOpening) -> Vec<Option<Start>> {
    let mut state = ghosts.state(BATCH);
    let (mut points, mut waves) = (Vec::new(), Vec::new());
    for first in (0..POINTS).step_by(BATCH) {
        ghosts.place(&mut state, (0, first as u64, BATCH), |_, _| {});
        let [x, y, z] = state.rays.positions();
        points.extend((0..BATCH).map(|i| DVec3::new(x[i], y[i], z[i])));
        waves.extend_from_slice(state.rays.wavelengths_nm());
    }
    waves.sort_unstable_by(f64::total_cmp);
    let nm = waves[waves.len() / 2];
    let start = |point: Option<DVec3>| point.map(|point| Start { point, nm, opening });
    ghosts.plan.zones.middles(&points).into_iter().map(start).collect()
}

/// Returns the column and row where light that enters at each place lands; `None` if it is lost.
fn landed(
    ghosts: &Ghosts,
    state: &mut ThreadState,
    way: &PathPlan,
    start: Start,
    places: &[[f64; 2]],
) -> Vec<Option<[f64; 2]>> {
    let (pipeline, size) = (&ghosts.pipeline, ghosts.pipeline.scene.imager.size());
    let mut landed = vec![None; places.len()];
    for (places, landed) in places.chunks(BATCH).zip(landed.chunks_mut(BATCH)) {
        state.rays.restart(places.len());
        let c = state.rays.columns_mut();
        let [x, y, z] = start.point.to_array();
        c.x.fill(x);
        c.y.fill(y);
        c.z.fill(z);
        c.wavelength_nm.fill(start.nm);
        (0..).zip(c.tag).for_each(|(number, tag)| *tag = number);
        state.rays.number(0, &ghosts.numbers, ESTIMATOR, 0, 0);
        Aims::at(places).send(&mut state.rays, start.opening);
        pipeline.tracer.follow(&way.route, &mut state.rays, &mut state.work);
        let ([x, y, z], [l, m, n]) = (state.rays.positions(), state.rays.directions());
        for (i, number) in state.rays.tags().iter().enumerate().filter(|(i, _)| state.rays.states()[*i] == ALIVE) {
            let way = -z[i] / n[i];
            let column = (0.5 - (x[i] + way * l[i]) / size.width_mm) * f64::from(size.width_px);
            let row = (0.5 + (y[i] + way * m[i]) / size.height_mm) * f64::from(size.height_px);
            landed[*number as usize] = (column.is_finite() && row.is_finite()).then_some([column, row]);
        }
    }
    landed
}
