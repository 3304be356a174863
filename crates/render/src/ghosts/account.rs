//! Where the light of lights goes: straight to the imager, to it by two reflections, or elsewhere.
//!
//! One set of rays, spread evenly over the front, follows the straight path, those of one reflection and those of two. What leaves a
//! path at a surface by reflection is what the path that turns there gets; so every watt is booked once, and the books close but for
//! rounding. What two reflections leave in the lens goes on by paths of more: it is not traced.

use super::Ghosts;
use crate::Workers;
use crate::error::RenderError;
use crate::pipeline::ThreadState;
use spectra_core::RayBatch;
use spectra_core::loss::ALIVE;
use spectra_core::workers::each_of;
use spectra_lens::{Act, Ledger, Lens, Path, StepLedger, Travel};

/// Rays for each path, and of a batch.
const RAYS: usize = 16_384;
const BATCH: usize = 256;
const MM2_PER_M2: f64 = 1e6;

/// Where the light of a source's lights goes that enters the lens, W in the band of the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightLedger {
    /// Enters the clear part of the first surface.
    pub emitted_w: f64,
    /// Falls on the frame straight, less what the imager sends back.
    pub direct_w: f64,
    /// Falls on it by two reflections, less what the imager sends back.
    pub ghosts_w: f64,
    /// Ends at rims, stops and blades.
    pub rims_w: f64,
    /// Is absorbed by glass, coatings and mirrors.
    pub absorbed_w: f64,
    /// Leaves by the front.
    pub front_w: f64,
    /// Falls beside the frame.
    pub beside_w: f64,
    /// Is reflected more than twice: no path of this order follows it.
    pub not_traced_w: f64,
    /// The paths by two reflections, brightest first.
    pub paths: Vec<GhostPath>,
}

/// What a path by reflections brings to the frame.
#[derive(Clone, Debug, PartialEq)]
pub struct GhostPath {
    /// The surfaces that reflect, in the order of the light, counted from 1; one more than the lens has is the imager.
    pub surfaces: Vec<usize>,
    /// On the frame, W.
    pub power_w: f64,
}

impl LightLedger {
    /// On the frame.
    #[must_use]
    pub fn detected_w(&self) -> f64 {
        self.direct_w + self.ghosts_w
    }

    /// Ends elsewhere.
    #[must_use]
    pub fn lost_w(&self) -> f64 {
        self.rims_w + self.absorbed_w + self.front_w + self.beside_w
    }
}

/// What one path did with its light.
struct Account {
    ledger: Ledger,
    /// Of what arrived: on the frame.
    on_frame: f64,
    /// What the last reflection sent on this path.
    entered: f64,
    /// Lost from there on.
    lost: StepLedger,
    /// Of that, at the imager beside the frame.
    beside: f64,
}

/// The ledger of a scene.
pub(super) fn of(
    ghosts: &Ghosts,
    lens: &Lens,
    surfaces: &[usize],
    workers: &dyn Workers,
) -> Result<LightLedger, RenderError> {
    let (count, imager) = (lens.elements.len(), lens.elements.len() - 1);
    let rays = started(ghosts);
    let follow = |state: &mut ThreadState, path: &Path| follow(ghosts, state, &rays, path, imager);
    let turned =
        |at: &[usize]| Path::reflected(count, Travel::Forward, at).expect("surfaces of the lens in their order");
    let fresh = || ghosts.state(BATCH);
    let by_first = each_of(workers, surfaces.len(), fresh, |state, at| {
        let first = surfaces[at];
        let once = follow(state, &turned(&[first]));
        let seconds = surfaces.iter().filter(|second| **second < first);
        let twice: Vec<_> = seconds.map(|second| (*second, follow(state, &turned(&[first, *second])))).collect();
        Ok::<_, RenderError>((first, once, twice))
    })?;
    let mut all = LightLedger::default();
    let book = |all: &mut LightLedger, account: &Account| {
        let lost = &account.lost;
        all.rims_w += lost.missed + lost.vignetted - account.beside;
        all.absorbed_w += lost.absorbed;
        all.beside_w += account.beside;
    };
    let straight = follow(&mut fresh(), &Path::through(count, Travel::Forward));
    let outside = straight.ledger.steps.first().map_or(0.0, |first| first.missed + first.vignetted);
    all.emitted_w = straight.ledger.launched - outside;
    all.rims_w -= outside;
    book(&mut all, &straight);
    all.direct_w = straight.on_frame;
    all.beside_w += straight.ledger.arrived - straight.on_frame;
    for (first, once, seconds) in by_first {
        // What neither passed there nor was reflected: coatings of metal absorb it, and beside the frame is no imager.
        let kept = straight.ledger.steps[first].elsewhere - once.entered;
        *(if first == imager { &mut all.beside_w } else { &mut all.absorbed_w }) += kept;
        book(&mut all, &once);
        all.front_w += once.ledger.arrived;
        let turn = last_turn(&turned(&[first]));
        let mut left = once.lost.elsewhere;
        for (second, twice) in seconds {
            let met = turn + (first - second);
            all.absorbed_w += once.ledger.steps[met].elsewhere - twice.entered;
            left -= once.ledger.steps[met].elsewhere;
            book(&mut all, &twice);
            all.ghosts_w += twice.on_frame;
            all.beside_w += twice.ledger.arrived - twice.on_frame;
            all.not_traced_w += twice.lost.elsewhere;
            all.paths.push(GhostPath { surfaces: vec![first + 1, second + 1], power_w: twice.on_frame });
        }
        // Sent back at surfaces that are none of the reflecting ones.
        all.not_traced_w += left;
    }
    let straight_left: f64 = straight.ledger.steps.iter().map(|s| s.elsewhere).sum();
    let followed: f64 = surfaces.iter().map(|at| straight.ledger.steps[*at].elsewhere).sum();
    all.not_traced_w += straight_left - followed;
    all.paths.sort_by(|a, b| b.power_w.total_cmp(&a.power_w).then(a.surfaces.cmp(&b.surfaces)));
    Ok(all.scaled(1.0 / (MM2_PER_M2 * RAYS as f64)))
}

impl LightLedger {
    fn scaled(mut self, by: f64) -> Self {
        let own = [
            &mut self.emitted_w,
            &mut self.direct_w,
            &mut self.ghosts_w,
            &mut self.rims_w,
            &mut self.absorbed_w,
            &mut self.front_w,
            &mut self.beside_w,
            &mut self.not_traced_w,
        ];
        own.into_iter().chain(self.paths.iter_mut().map(|path| &mut path.power_w)).for_each(|value| *value *= by);
        self
    }
}

/// The step at which a path turns last; 0 where it does not.
fn last_turn(path: &Path) -> usize {
    path.steps().iter().rposition(|step| step.act == Act::Reflect).unwrap_or(0)
}

/// Rays all over the front, as they enter the lens: all paths share them.
fn started(ghosts: &Ghosts) -> Vec<RayBatch> {
    let everywhere = vec![super::Guide::everywhere(); ghosts.plan.zones.count()];
    let mut state = ghosts.state(BATCH);
    let mut start = |first: usize| {
        ghosts.start(&mut state, &everywhere, (0, first as u64, BATCH), |_, _| {});
        state.rays.clone()
    };
    (0..RAYS).step_by(BATCH).map(&mut start).collect()
}

fn follow(ghosts: &Ghosts, state: &mut ThreadState, rays: &[RayBatch], path: &Path, imager: usize) -> Account {
    let pipeline = &ghosts.pipeline;
    let work = pipeline.tracer.work_in_place(BATCH).with_ledger();
    let old = std::mem::replace(&mut state.work, work);
    let route = pipeline.tracer.route(path);
    let forward = path.leaves() == Travel::Forward;
    let mut on_frame = 0.0;
    for batch in rays {
        state.rays = batch.clone();
        pipeline.tracer.follow(&route, &mut state.rays, &mut state.work);
        if forward {
            state.rays.set_stage(spectra_core::numbers::StageKey::IMAGER);
            ghosts.receive().receive(&mut state.rays, pipeline.isa);
            let rays = &state.rays;
            let alive = rays.states().iter().zip(rays.weights()).filter(|(state, _)| **state == ALIVE);
            on_frame += alive.map(|(_, weight)| weight).sum::<f64>();
        }
    }
    let mut work = std::mem::replace(&mut state.work, old);
    let ledger = work.take_ledger().unwrap_or_default();
    let turns = path.reflections().count() > 0;
    let own = if turns { last_turn(path) + 1 } else { 0 };
    let lost = ledger.lost_from(own);
    let at_imager = path.steps().iter().zip(&ledger.steps).skip(own).filter(|(step, _)| step.element == imager);
    let beside = at_imager.map(|(_, step)| step.missed + step.vignetted).sum();
    let entered = ledger.arrived + lost.total();
    Account { ledger, on_frame, entered, lost, beside }
}
