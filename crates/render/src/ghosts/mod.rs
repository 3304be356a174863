//! Ghosts: light of the bright lights that surfaces of the lens reflect on its way to the imager.
//!
//! **Model.** A ghost path is an ordinary path with two or four reflections. There is one for each pair of surfaces whose coating reflects;
//! the imager counts as one more surface, in the image plane. Light is traced forward, as in [`crate::forward`], and along each path
//! exactly as straight through; no matrix approximates a path. The source places the ray on the light, and the wavelength density gives its
//! color. [`FrontOpening`] is the sphere around the clear part of the first surface. Seen from the light it is a disk across the line of
//! sight, at any angle, so a fisheye needs no special case. The path's guide draws a place on the square around that disk, and the weight
//! is multiplied by the solid angle over the density of the place.
//!
//! **Guides.** A pilot finds, for each path and zone of the source, where on the front of the lens its light enters ([`guide`], `pilot`),
//! and how many rays each path needs. Rays are shared out to minimize the noise of blocks of 32 x 32 pixels, relative to the ghosts' light
//! there. No block is left much noisier than the mean ([`path_cells`]). The noise is that of luminance if the picture has it, else of the sum
//! of the channels. Paths get rays in proportion to their noise over the root of their cost (Neyman's allocation). A tenth of each path's
//! rays goes all over the front, so that no path is biased, whatever the pilot overlooked.
//!
//! **Footprints.** A ghost is smooth, so the light of a ray is spread over a square of pixels as it lands (`ghost_footprints`, `width`,
//! `probe_grid`, [`crate::footprint`]). A ray's integers are divided into equal shares, and the pixel that the ray meets gets the remainder, so the
//! shares add up to the ray exactly. On a mosaic each pixel gets its share of what its own channel sees of the ray. With `spread: none`
//! each ray adds to one pixel; rays and totals of each path are the same to the last bit, except on mosaics. `xtask/ghost_noise.py`
//! compares the two.
//!
//! **Blocks.** A unit of work has some rays of every path, so any number of units is a fair picture. Stepping, saving and stopping need
//! nothing else.
//!
//! **Four reflections** are traced if requested: see `ledger`, which also books where all light goes.
//!
//! **When.** Unless the scene decides, ghosts are on if lights are rendered apart from the rest and the brightest block has more than 1 %
//! of the rest's mean. Dimmer ghosts get fewer rays, down to an eighth of a ray per pixel and sample.
//!
//! **Limits.** Prisms take no part: ghosts that their faces reflect are missing, and the scene is warned. Paths of four reflections are not
//! spread if lights lie in several zones; nor are rays that the source directs itself, nor what meters see.

mod aims;
mod density;
mod ghost_footprints;
mod guide;
mod ledger;
mod metered;
mod neighbors;
mod path_cells;
mod pilot;
mod pilot_hit;
mod pilot_rays;
mod probe_grid;
mod probes;
mod tree;
mod width;
mod zones;

pub use ledger::{GhostPath, LightLedger};

use crate::error::RenderError;
use crate::estimator::{Estimator, Scratch, UnitResult};
use crate::finite_check::FiniteCheck;
use crate::forward::source_points;
use crate::non_finite::Step;
use crate::options::GhostRays;
use crate::pilot::PILOT_SEED;
use crate::pipeline::{Pipeline, ThreadState};
use crate::sums::{ExactSums, OwnSums, scale_for};
use crate::{Done, Workers};
use aims::Aims;
use ghost_footprints::GhostFootprints;
use glam::DVec3;
use guide::Guide;
use spectra_core::RayBatch;
use spectra_core::batch::pixel_and_channel;
use spectra_core::loss::ALIVE;
use spectra_core::numbers::{Numbers, StageKey, mix64};
use spectra_core::stage::{Emit, Receive};
use spectra_core::workers::map_pieces;
use spectra_optics::FrontOpening;
use spectra_scene::{GhostSpread, LightKind, Scene};
use spectra_tracer::{Indices, Path, Route, Tracer, Travel};
use std::ops::Range;
use std::sync::Arc;
use zones::Zones;

/// Threshold above which ghosts or diffraction are computed without being requested. Ghosts: the brightest block, as a fraction of the mean
/// of the frame. Diffraction: the brightest star, as a fraction of the median of the frame.
pub(crate) const MATTERS: f64 = 0.01;

/// Estimator name from which the stages derive their own random numbers.
pub(crate) const ESTIMATOR: &str = "ghosts";
/// Turns the picture's seed into that of the ghosts.
const SEED: u64 = 0x6768_6f73_7473;

/// Number of rays per pixel and sample.
const RAYS_A_PIXEL: f64 = 0.9;
/// Smallest number of rays per pixel and sample. Ghosts that are traced because lights are bright get fewer rays the dimmer they are, in
/// proportion to the brightest block over the mean of the frame.
const LEAST_A_PIXEL: f64 = 0.125;
/// Smallest number of rays of a sample for each path.
const LEAST_A_PATH: u64 = 64;
/// Number of rays in a unit of work, which takes some milliseconds.
const RAYS_PER_BLOCK: u64 = 1 << 16;
/// One part in this many of the rays is shared out evenly, whatever the pilot found.
const FLOOR: u64 = 8;
/// Cost of a ray in addition to its surfaces, in surfaces.
const OVERHEAD: f64 = 8.0;

/// Headroom of the sums for rays brighter than the pilot saw.
const HEADROOM: f64 = 4.0;
/// Number of rays of each path from which the scale of the sums is found.
const SCALE_RAYS: u64 = 4096;

/// A ghost path and the plan of its rays.
#[derive(Clone)]
struct PathPlan {
    route: Route,
    /// Surfaces that reflect, counted from 1.
    surfaces: Vec<usize>,
    /// Guides for the zones of the source; one for all zones if the path has more than two reflections.
    guides: Vec<Guide>,
    /// Number of rays in a block.
    rays: u64,
    /// Factor for the weight of each ray: the number of rays of all paths in a block, divided by the number of this path.
    boost: f64,
    /// First cell of the separate sums of this path, if it has any.
    own_cells: Option<usize>,
}

impl PathPlan {
    /// Whether no more than two surfaces reflect.
    fn is_of_pair(&self) -> bool {
        self.surfaces.len() <= 2
    }

    /// Returns the cost of a ray, in surfaces.
    fn cost(&self) -> f64 {
        self.route.steps() as f64 + OVERHEAD
    }
}

/// The results of the search, found once per scene.
#[derive(Clone)]
struct Plan {
    /// Front opening where light enters; `None` if the source sets directions itself.
    opening: Option<FrontOpening>,
    zones: Zones,
    ways: Vec<PathPlan>,
    /// Number of rays in a block, over all paths.
    rays: u64,
    blocks_a_sample: u64,
    ledger: LightLedger,
    /// Paths that have separate sums.
    apart: Vec<Vec<usize>>,
}

/// The place where a ray that landed entered the lens: its zone, and its position on the front.
#[derive(Clone, Copy, Debug)]
struct Entrance {
    zone: usize,
    place: [f64; 2],
    /// Direction of the ray's source point around the axis, a unit vector.
    azimuth: [f64; 2],
}

/// Estimator of ghosts.
pub(crate) struct Ghosts {
    pipeline: Arc<Pipeline>,
    plan: Arc<Plan>,
    /// Footprints over which light is spread; `None` if all light of a ray stays in the pixel that it meets.
    spreading: Option<Arc<GhostFootprints>>,
    numbers: Numbers,
    scale: f64,
}

impl Ghosts {
    /// Searches the paths of the light of a share of the source and finds the scale of the sums. `None` if nothing reflects, or if the
    /// brightest block of 32 x 32 pixels has no more than `matters` (W/m2, summed over its channels).
    pub(crate) fn new(
        pipeline: &Pipeline,
        matters: Option<f64>,
        share: GhostRays,
        workers: &dyn Workers,
    ) -> Result<Option<Self>, RenderError> {
        let scene = &pipeline.scene;
        let emit = pipeline.source().emit().ok_or(RenderError::CannotEmit)?;
        scene.imager.receive().ok_or(RenderError::CannotReceive)?;
        let reflections = scene.render.reflections;
        let part = reflections.imager;
        let corners = crate::landing::corners(scene);
        let lens = spectra_lens::Lens::clone(&scene.lens).with_reflecting_imager(|_| part, corners);
        let indices = Indices::Band { min_nm: scene.grid.start_nm, max_nm: scene.grid.end_nm() };
        let tracer = Tracer::new(&lens, indices).map_err(|e| RenderError::Lens(e.to_string()))?;
        let (count, imager) = (lens.elements.len(), lens.elements.len() - 1);
        let mut surfaces = tracer.reflecting();
        surfaces.retain(|at| part > 0.0 || *at != imager);
        if surfaces.is_empty() {
            return Ok(None);
        }
        let pipeline = Arc::new(pipeline.with_tracer(Arc::new(tracer)));
        let opening =
            if emit.is_directed() { None } else { Some(FrontOpening::of(&lens).ok_or(RenderError::NoAperture)?) };
        let numbers = pipeline.numbers(PILOT_SEED ^ SEED);
        let zones = opening.as_ref().map_or_else(Zones::one, |opening| {
            let points = source_points(&pipeline, emit, &numbers);
            Zones::new(&points, opening.center(), lens.has_axis_of_revolution())
        });
        let everywhere = Guide::everywhere();
        // The light that reaches the imager counts, not what it keeps: exposure is incident light.
        let way = |path: Path| {
            let surfaces: Vec<usize> = path.reflections().map(|at| at + 1).collect();
            let route = pipeline.tracer.route(&path.before(imager));
            let zones = if surfaces.len() > 2 { 1 } else { zones.count() };
            PathPlan { route, surfaces, guides: vec![everywhere.clone(); zones], rays: 1, boost: 1.0, own_cells: None }
        };
        let ways: Vec<PathPlan> = Path::ghosts(count, &surfaces, 2).into_iter().map(&way).collect();
        let zones = zones.clone();
        let plan = Plan::new(opening, zones, ways);
        let (pipeline, plan) = (Arc::clone(&pipeline), Arc::new(plan));
        let mut own = Self { pipeline, plan, spreading: None, numbers, scale: 1.0 };
        let order = reflections.order.unwrap_or(2);
        let mut ledger = None;
        if order > 2 {
            // The ledger tells which paths of more reflections have enough light.
            let books = ledger::of(&own, &lens, &surfaces, order, workers)?;
            let mut more: Vec<&[usize]> = books.paths.iter().map(|path| &path.surfaces[..]).collect();
            more.retain(|surfaces| surfaces.len() > 2);
            more.sort_unstable();
            let path = |surfaces: &[usize]| {
                let at: Vec<usize> = surfaces.iter().map(|at| at - 1).collect();
                Path::reflected(count, Travel::Forward, &at).expect("a path from the ledger")
            };
            let ways = more.into_iter().map(|surfaces| way(path(surfaces))).collect();
            own.plan = Arc::new(own.plan.with(ways));
            ledger = Some(books);
        }
        let found = match share {
            GhostRays::Found => pilot::search(&own, matters, workers)?,
            GhostRays::Even => Some(pilot::Plan::even(&own)),
        };
        let Some(found) = found else { return Ok(None) };
        let ledger = match ledger {
            Some(ledger) => ledger,
            None => ledger::of(&own, &lens, &surfaces, order, workers)?,
        };
        let a_sample = own.rays_a_sample(matters, found.brightest);
        own.plan = Arc::new(own.shared_out(found.ways, a_sample, ledger));
        own.scale = own.pilot_scale(workers)?;
        if reflections.spread == GhostSpread::Footprint {
            own.spreading = GhostFootprints::of(&own, workers)?.map(Arc::new);
        }
        own.numbers = own.of_seed(own.pipeline.seed);
        Ok(Some(own))
    }

    /// Returns the random numbers of a seed.
    fn of_seed(&self, seed: u64) -> Numbers {
        self.pipeline.numbers(mix64(seed ^ SEED))
    }

    /// Ledger of where the light goes.
    pub(crate) fn ledger(&self) -> &LightLedger {
        &self.plan.ledger
    }

    fn emit(&self) -> &dyn Emit {
        self.pipeline.source().emit().expect("checked by `new`")
    }

    fn receive(&self) -> &dyn Receive {
        self.pipeline.scene.imager.receive().expect("checked by `new`")
    }

    fn state(&self, capacity: usize) -> ThreadState {
        // Polarized if the scene asks for it, however steep the lens is.
        let rays = RayBatch::new(capacity).on(self.pipeline.isa);
        let rays = if self.pipeline.scene.render.reflections.polarized { rays.with_polarization() } else { rays };
        let rays = if self.pipeline.draws { rays.with_numbers() } else { rays };
        ThreadState { rays, ..ThreadState::new(&self.pipeline, capacity) }
    }

    /// Places rays `first .. first + len` of a stream on the source, with the random numbers of all dimensions.
    fn place(
        &self,
        state: &mut ThreadState,
        (stream, first, len): (u64, u64, usize),
        mut look: impl FnMut(Step, &RayBatch),
    ) {
        let isa = self.pipeline.isa;
        for (dimension, column) in state.numbers.iter_mut().enumerate() {
            let group = self.pipeline.group(dimension);
            self.numbers.fill_rotated(isa, stream, first, group, dimension as u32, column.slice_mut(len));
        }
        state.draw_wavelengths(&self.pipeline, len);
        look(Step::Wavelengths, &state.rays);
        state.rays.number(0, &self.numbers, ESTIMATOR, stream, first);
        state.rays.set_stage(StageKey::SOURCE);
        let [_, u, v, _, _] = &state.numbers;
        self.emit().place(&mut state.rays, u.slice(len), v.slice(len));
        look(Step::Source, &state.rays);
    }

    /// Aims rays from the source at the front, by two random numbers each, and returns where each ray is aimed.
    fn aim(&self, rays: &mut RayBatch, guides: &[Guide], numbers: [&[f64]; 2]) -> Aims {
        let Some(opening) = &self.plan.opening else { return Aims::of_numbers(numbers) };
        let [x, y, z] = rays.positions();
        let zone = |i: usize| self.plan.zones.of(DVec3::new(x[i], y[i], z[i])).min(guides.len() - 1);
        let zones = if guides.len() == 1 { vec![0; x.len()] } else { (0..x.len()).map(zone).collect() };
        let mut aims = Aims::drawn(guides, zones, numbers, self.pipeline.isa);
        if self.spreading.is_some() {
            aims.note_azimuths(rays);
        }
        aims.send(rays, *opening);
        aims
    }

    /// Starts rays `first .. first + len` of a stream on the source and aims them at the front.
    fn start(
        &self,
        state: &mut ThreadState,
        guides: &[Guide],
        span: (u64, u64, usize),
        mut look: impl FnMut(Step, &RayBatch),
    ) -> Aims {
        self.place(state, span, &mut look);
        let [.., a, b] = &state.numbers;
        let aims = self.aim(&mut state.rays, guides, [a, b].map(|numbers| numbers.slice(span.2)));
        if self.plan.opening.is_some() {
            look(Step::Pupil, &state.rays);
        }
        self.emit().radiate(&mut state.rays);
        look(Step::Source, &state.rays);
        aims
    }

    /// Traces rays from the front to the pixels. Returns for each ray that is left its number in the batch.
    fn finish(&self, state: &mut ThreadState, route: &Route, mut look: impl FnMut(Step, &RayBatch)) -> Vec<u32> {
        let isa = self.pipeline.isa;
        (0..).zip(state.rays.columns_mut().tag).for_each(|(number, tag)| *tag = number);
        self.pipeline.tracer.follow(route, &mut state.rays, &mut state.work);
        let numbers = state.rays.tags().to_vec();
        look(Step::Lens, &state.rays);
        state.rays.set_stage(StageKey::IMAGER);
        self.receive().receive(&mut state.rays);
        look(Step::Imager, &state.rays);
        state.settle(isa);
        numbers
    }

    /// Traces rays `first .. first + len` of a path. Rays that arrived are left in the batch, with their pixels in the tags. Returns where
    /// each of them entered the lens.
    fn batch(
        &self,
        state: &mut ThreadState,
        at: usize,
        (first, len): (u64, usize),
        mut look: impl FnMut(Step, &RayBatch),
    ) -> Vec<Entrance> {
        let way = &self.plan.ways[at];
        let aims = self.start(state, &way.guides, (at as u64 + 1, first, len), &mut look);
        let numbers = self.finish(state, &way.route, &mut look);
        let alive = numbers.iter().zip(state.rays.states()).filter(|(_, state)| **state == ALIVE);
        let landed = alive.map(|(number, _)| aims.landed(*number as usize)).collect();
        state.rays.compact();
        state.rays.weight_columns().weight.iter_mut().for_each(|weight| *weight *= way.boost);
        landed
    }

    /// Returns what each ray of a batch brings to each channel, ray by ray.
    fn contributions(&self, state: &mut ThreadState) -> Vec<f64> {
        let (len, channels) = (state.rays.len(), self.pipeline.responses.channels());
        let mut brought = vec![0.0; len * channels];
        for channel in 0..channels {
            let values = &mut state.values[..len];
            let (nm, weights) = (state.rays.wavelengths_nm(), state.rays.weights());
            self.pipeline.isa.run(self.pipeline.responses.weigh(channel, nm, weights, values));
            let own = brought.iter_mut().skip(channel).step_by(channels);
            for ((own, value), tag) in own.zip(values).zip(state.rays.tags()) {
                let only = pixel_and_channel(*tag).1;
                if only.is_none_or(|only| only as usize == self.pipeline.recorded[channel]) {
                    *own = *value;
                }
            }
        }
        brought
    }

    /// Number of sums for all paths together: one for each pixel and channel.
    fn cells(&self) -> usize {
        self.pipeline.scene.imager.size().pixels() * self.pipeline.recorded.len()
    }

    /// Returns the number of rays in a sample if the brightest block has this much light.
    fn rays_a_sample(&self, matters: Option<f64>, brightest: f64) -> u64 {
        let a_pixel = matters.map_or(RAYS_A_PIXEL, |matters| {
            // The threshold is a fraction of the mean.
            RAYS_A_PIXEL * (MATTERS * brightest / matters).clamp(LEAST_A_PIXEL, 1.0)
        });
        let pixels = self.pipeline.scene.imager.size().pixels() as f64;
        ((pixels * a_pixel) as u64).max(self.plan.ways.len() as u64 * LEAST_A_PATH)
    }

    /// Shares the rays of a sample out over the paths.
    fn shared_out(&self, found: Vec<(Vec<Guide>, f64)>, a_sample: u64, ledger: LightLedger) -> Plan {
        let old = &self.plan;
        let paths = old.ways.len() as u64;
        let blocks_a_sample = a_sample.div_ceil(RAYS_PER_BLOCK);
        let a_block = a_sample / blocks_a_sample;
        let floor = (a_block / (FLOOR * paths)).max(1);
        let needs: Vec<f64> =
            found.iter().zip(&old.ways).map(|((_, variance), way)| (variance / way.cost()).sqrt()).collect();
        let sum: f64 = needs.iter().sum();
        let left = a_block.saturating_sub(floor * paths) as f64;
        let share = |need: f64| if sum > 0.0 { (left * need / sum) as u64 } else { 0 };
        let counts: Vec<u64> = needs.iter().map(|need| floor + share(*need)).collect();
        let rays: u64 = counts.iter().sum();
        let apart = ledger.strongest(self.pipeline.scene.ghost_paths());
        let way = |(((guides, _), way), count): (((Vec<Guide>, f64), &PathPlan), &u64)| PathPlan {
            route: way.route.clone(),
            surfaces: way.surfaces.clone(),
            guides,
            rays: *count,
            boost: rays as f64 / *count as f64,
            own_cells: apart.iter().position(|path| *path == way.surfaces).map(|at| (at + 1) * self.cells()),
        };
        let ways = found.into_iter().zip(&old.ways).zip(&counts).map(way).collect();
        Plan { opening: old.opening, zones: old.zones.clone(), ways, rays, blocks_a_sample, ledger, apart }
    }

    /// Returns the exposure, J/m2 in the time `time_s`, that one unit of the sums stands for after `rays` rays.
    fn worth(&self, rays: u64, time_s: f64) -> f64 {
        time_s / self.scale / self.pipeline.scene.imager.size().pixel_area_mm2() / rays.max(1) as f64
    }

    /// Finds the scale of the sums from some rays of each path.
    fn pilot_scale(&self, workers: &dyn Workers) -> Result<f64, RenderError> {
        let capacity = self.pipeline.scene.render.batch;
        let look = |state: &mut ThreadState, at: usize| {
            let mut largest = 0.0_f64;
            for (first, len) in spans(0..self.plan.ways[at].rays.min(SCALE_RAYS), capacity) {
                let mut blame = FiniteCheck::default();
                self.batch(state, at, (first, len), |step, rays| blame.look(step, rays));
                if blame.no_number(&self.pipeline).is_some() {
                    // Trace in a fresh state: positions left over from rays that ended in another batch must not be blamed.
                    let (mut blame, mut again) = (FiniteCheck::default(), self.state(capacity));
                    self.batch(&mut again, at, (first, len), |step, rays| blame.look(step, rays));
                    if let Some(error) = blame.no_number(&self.pipeline) {
                        return Err(error);
                    }
                }
                largest = largest.max(state.largest(&self.pipeline));
            }
            Ok(largest)
        };
        let each = map_pieces(workers, self.plan.ways.len(), || self.state(capacity), look)?;
        let largest = each.into_iter().fold(0.0, f64::max);
        Ok(scale_for(largest * HEADROOM * self.pipeline.source().peak_over_mean().max(1.0)))
    }

    /// Traces a block of rays of all paths and adds it to the sums.
    fn block(&self, state: &mut ThreadState, block: u64, sums: &ExactSums) -> UnitResult {
        let (mut rays, mut error) = (0, None);
        for (at, way) in self.plan.ways.iter().enumerate() {
            let all = block * way.rays..(block + 1) * way.rays;
            for (first, len) in spans(all, state.rays.capacity()) {
                let landed = self.batch(state, at, (first, len), |_, _| {});
                if !state.contributions(&self.pipeline, self.scale) {
                    state.contributions_that_fit(&self.pipeline, self.scale);
                    if error.is_none() {
                        let (mut blame, mut again) = (FiniteCheck::default(), self.state(state.rays.capacity()));
                        self.batch(&mut again, at, (first, len), |step, rays| blame.look(step, rays));
                        error = Some(blame.error(&self.pipeline, &mut again, self.scale));
                    }
                }
                rays += len as u64;
                if let Some(spreading) = &self.spreading {
                    spreading.add(state, (at, block / self.plan.blocks_a_sample), &landed, way.own_cells, sums);
                    continue;
                }
                let (tags, recorded) = (state.rays.tags(), &self.pipeline.recorded[..]);
                match &mut state.own {
                    Some(own) => own.add(tags, &state.integers, recorded, sums),
                    None => sums.add_rays(0, tags, &state.integers, recorded),
                }
                if let Some(first) = way.own_cells {
                    sums.add_rays(first, tags, &state.integers, recorded);
                }
            }
        }
        UnitResult { rays, error }
    }
}

impl Plan {
    /// Creates a plan whose rays are not yet shared out.
    fn new(opening: Option<FrontOpening>, zones: Zones, ways: Vec<PathPlan>) -> Self {
        let (ledger, apart) = (LightLedger::default(), Vec::new());
        Self { opening, zones, ways, rays: 1, blocks_a_sample: 1, ledger, apart }
    }

    /// Returns the plan with more paths, whose rays are not yet shared out.
    fn with(&self, more: Vec<PathPlan>) -> Self {
        let ways = self.ways.iter().cloned().chain(more).collect();
        Self::new(self.opening, self.zones.clone(), ways)
    }
}

/// Divides a range of rays into batches: the first ray and the number of rays of each.
fn spans(rays: Range<u64>, capacity: usize) -> impl Iterator<Item = (u64, usize)> {
    let end = rays.end;
    rays.step_by(capacity).map(move |first| (first, capacity.min((end - first) as usize)))
}

impl Estimator for Ghosts {
    fn name(&self) -> &'static str {
        ESTIMATOR
    }

    fn light(&self) -> LightKind {
        LightKind::Ghosts
    }

    fn tiles(&self) -> usize {
        1
    }

    fn paths(&self) -> &[Vec<usize>] {
        &self.plan.apart
    }

    fn tile_of(&self, _pixel: usize) -> usize {
        0
    }

    fn reseeded(&self, picture: &Arc<Scene>, seed: u64) -> Box<dyn Estimator> {
        let (pipeline, plan) = (Arc::new(self.pipeline.of_picture(picture)), self.plan.clone());
        let spreading = self.spreading.clone();
        Box::new(Self { pipeline, plan, spreading, numbers: self.of_seed(seed), scale: self.scale })
    }

    fn units(&self, samples: &Range<u64>, tiles: &[u32]) -> u64 {
        if tiles.is_empty() { 0 } else { (samples.end - samples.start) * self.plan.blocks_a_sample }
    }

    fn rays(&self, samples: &Range<u64>, tiles: &[u32]) -> u64 {
        self.units(samples, tiles) * self.plan.rays
    }

    fn scratch(&self) -> Scratch {
        let mut state = self.state(self.pipeline.scene.render.batch);
        match &self.spreading {
            Some(spreading) => state.steps = spreading.spreader.steps(),
            None => state.own = OwnSums::new(self.cells()),
        }
        Scratch(state)
    }

    fn run(
        &self,
        samples: &Range<u64>,
        _tiles: &[u32],
        unit: u64,
        scratch: &mut Scratch,
        sums: &ExactSums,
    ) -> UnitResult {
        self.block(&mut scratch.0, samples.start * self.plan.blocks_a_sample + unit, sums)
    }

    fn expected_noise(&self, samples: u64) -> Option<f64> {
        self.spreading.as_ref().map(|spreading| spreading.width.noise(samples, spreading.spreader.most_half))
    }

    fn weights(&self, _done: &[&Done], rays: u64, time_s: f64) -> Vec<f64> {
        let size = self.pipeline.scene.imager.size();
        vec![self.worth(rays, time_s); size.pixels()]
    }

    fn metered(&self, workers: &dyn Workers) -> Result<Vec<Vec<f64>>, RenderError> {
        self.of_meters(workers).map_or(Ok(Vec::new()), |meters| meters?.meter(workers))
    }
}
