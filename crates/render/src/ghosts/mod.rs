//! Ghosts: light of the source's lights that surfaces of the lens reflect on its way to the imager.
//!
//! Forward, as [`crate::forward`], but along paths by two reflections, or four, each traced exactly as the straight one. A pilot run finds for
//! each path and zone of the source where on the front of the lens its light comes in ([`guide`]), and how much each path needs: rays
//! are shared out so that the noise of 32 x 32 pixels, as a part of the ghosts' light there (of luminance, where a picture has it), is
//! least, and nowhere much more than elsewhere ([`shares`]). A tenth of every path's rays goes all over the front, so that no path has a bias whatever the pilot overlooked.

mod account;
mod aims;
mod density;
mod guide;
mod metered;
mod net;
mod pilot;
mod probes;
mod seen;
mod shares;
mod sight;
mod spread;
mod spreading;
mod tree;
mod width;
mod zones;

pub use account::{GhostPath, LightLedger};

use crate::blame::Blame;
use crate::error::RenderError;
use crate::estimator::{Estimator, Scratch, Unit};
use crate::forward::source_points;
use crate::no_number::Step;
use crate::pilot::PILOT_SEED;
use crate::pipeline::{Pipeline, ThreadState};
use crate::sums::{ExactSums, OwnSums, scale_for};
use crate::{Done, Workers};
use aims::Aims;
use glam::DVec3;
use guide::Guide;
use spectra_core::RayBatch;
use spectra_core::batch::pixel_and_channel;
use spectra_core::loss::ALIVE;
use spectra_core::numbers::{Numbers, StageKey, mix64};
use spectra_core::stage::{Emit, Receive};
use spectra_core::workers::each_of;
use spectra_lens::{FrontOpening, Indices, Path, Route, Tracer, Travel};
use spectra_scene::GhostSpread;
use spreading::Spreading;
use std::ops::Range;
use std::sync::Arc;
use zones::Zones;

/// How rays are shared out over the paths of ghosts, and where on the front each begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GhostRays {
    /// As a search before finds it best.
    #[default]
    Found,
    /// As many for each path, all over the front: what the search is measured against.
    Even,
}

/// Ghosts matter by themselves where the brightest of them has more than this part of the mean of the frame, diffraction where the
/// brightest star has more of its median.
pub(crate) const MATTERS: f64 = 0.01;

/// What numbers of its own stages draw by.
pub(crate) const ESTIMATOR: &str = "ghosts";
/// Turns the picture's seed into that of the ghosts.
const SEED: u64 = 0x6768_6f73_7473;

/// Rays for each pixel and sample, and in all of a sample at least for each path. Where ghosts are traced because lights are bright,
/// dim ones get fewer, as the brightest block is to the mean of the frame.
const RAYS_A_PIXEL: f64 = 0.9;
const LEAST_A_PIXEL: f64 = 0.125;
const LEAST_A_PATH: u64 = 64;
/// Rays of a unit of work: some milliseconds.
const RAYS_PER_BLOCK: u64 = 1 << 16;
/// This part of the rays is shared out evenly, whatever the pilot found.
const FLOOR: u64 = 8;
/// What a ray costs beside its surfaces, in surfaces.
const OVERHEAD: f64 = 8.0;

/// Room of the sums for rays that the pilot has not seen, and rays of each path that it looks at.
const HEADROOM: f64 = 4.0;
const SCALE_RAYS: u64 = 4096;

/// One path.
#[derive(Clone)]
struct Way {
    route: Route,
    /// The surfaces that reflect, counted from 1.
    surfaces: Vec<usize>,
    /// By the zones of the source; of more than two reflections one for all.
    guides: Vec<Guide>,
    /// Rays of a block, and what each of them weighs for those of all paths.
    rays: u64,
    boost: f64,
    /// Sums of its own, if it has any: the first of them.
    own_cells: Option<usize>,
}

impl Way {
    /// Whether two surfaces reflect, and no more.
    fn is_of_pair(&self) -> bool {
        self.surfaces.len() <= 2
    }

    /// What a ray takes, in surfaces.
    fn cost(&self) -> f64 {
        self.route.steps() as f64 + OVERHEAD
    }
}

/// What was found once for a scene.
#[derive(Clone)]
struct Plan {
    /// Where light enters; `None` of a source that sets its directions itself.
    opening: Option<FrontOpening>,
    zones: Zones,
    ways: Vec<Way>,
    /// Rays of a block of all paths.
    rays: u64,
    blocks_a_sample: u64,
    ledger: LightLedger,
    /// Paths that have sums of their own.
    apart: Vec<Vec<usize>>,
}

/// Where a ray that landed went in: its zone, and its place on the front.
#[derive(Clone, Copy, Debug)]
struct Landed {
    zone: usize,
    place: [f64; 2],
    /// Where around the axis its source lies: a unit vector.
    azimuth: [f64; 2],
}

pub(crate) struct Ghosts {
    pipeline: Arc<Pipeline>,
    plan: Arc<Plan>,
    /// `None` where all light of a ray stays in the pixel that it meets.
    spreading: Option<Arc<Spreading>>,
    numbers: Numbers,
    scale: f64,
}

impl Ghosts {
    /// Searches the ways of the light of a share of the source, and finds the scale of the sums. `None` where nothing reflects, or
    /// where the brightest block of 32 x 32 pixels has no more than `matters` (W/m2, the sum of its channels).
    pub(crate) fn new(
        pipeline: &Pipeline,
        matters: Option<f64>,
        workers: &dyn Workers,
    ) -> Result<Option<Self>, RenderError> {
        Self::with_rays(pipeline, matters, GhostRays::Found, workers)
    }

    /// The same, with its rays shared out otherwise.
    pub(crate) fn with_rays(
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
        let corners = crate::landing::corners(scene, pipeline.isa);
        let lens = spectra_lens::Lens::clone(&scene.lens).with_reflecting_imager(|_| part, corners);
        let indices = Indices::Band { min_nm: scene.grid.start_nm, max_nm: scene.grid.end_nm() };
        let tracer = Tracer::new(&lens, indices, pipeline.isa).map_err(|e| RenderError::Lens(e.to_string()))?;
        let (count, imager) = (lens.elements.len(), lens.elements.len() - 1);
        let mut surfaces = tracer.reflecting();
        surfaces.retain(|at| part > 0.0 || *at != imager);
        if surfaces.is_empty() {
            return Ok(None);
        }
        let pipeline = Arc::new(pipeline.with_tracer(tracer));
        let opening =
            if emit.is_directed() { None } else { Some(FrontOpening::of(&lens).ok_or(RenderError::NoAperture)?) };
        let numbers = pipeline.numbers(PILOT_SEED ^ SEED);
        let zones = opening.as_ref().map_or_else(Zones::one, |opening| {
            let points = source_points(&pipeline, emit, &numbers);
            Zones::new(&points, opening.center(), lens.has_axis_of_revolution())
        });
        let everywhere = Guide::everywhere();
        // What reaches the imager counts, not what it keeps: exposure is incident light.
        let way = |path: Path| {
            let surfaces: Vec<usize> = path.reflections().map(|at| at + 1).collect();
            let route = pipeline.tracer.route(&path.before(imager));
            let zones = if surfaces.len() > 2 { 1 } else { zones.count() };
            Way { route, surfaces, guides: vec![everywhere.clone(); zones], rays: 1, boost: 1.0, own_cells: None }
        };
        let ways: Vec<Way> = Path::ghosts(count, &surfaces, 2).into_iter().map(&way).collect();
        let zones = zones.clone();
        let plan = Plan::new(opening, zones, ways);
        let (pipeline, plan) = (Arc::clone(&pipeline), Arc::new(plan));
        let mut own = Self { pipeline, plan, spreading: None, numbers, scale: 1.0 };
        let order = reflections.order.unwrap_or(2);
        let mut ledger = None;
        if order > 2 {
            // The books say which paths of more have enough.
            let books = account::of(&own, &lens, &surfaces, order, workers)?;
            let mut more: Vec<&[usize]> = books.paths.iter().map(|path| &path.surfaces[..]).collect();
            more.retain(|surfaces| surfaces.len() > 2);
            more.sort_unstable();
            let path = |surfaces: &[usize]| {
                let at: Vec<usize> = surfaces.iter().map(|at| at - 1).collect();
                Path::reflected(count, Travel::Forward, &at).expect("the books follow paths")
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
            None => account::of(&own, &lens, &surfaces, order, workers)?,
        };
        let a_sample = own.rays_a_sample(matters, found.brightest);
        own.plan = Arc::new(own.shared_out(found.ways, a_sample, ledger));
        own.scale = own.pilot_scale(workers)?;
        if reflections.spread == GhostSpread::Footprint {
            own.spreading = Spreading::of(&own, workers)?.map(Arc::new);
        }
        own.numbers = own.of_seed(own.pipeline.seed);
        Ok(Some(own))
    }

    fn of_seed(&self, seed: u64) -> Numbers {
        self.pipeline.numbers(mix64(seed ^ SEED))
    }

    /// Where the light goes.
    pub(crate) fn ledger(&self) -> &LightLedger {
        &self.plan.ledger
    }

    fn emit(&self) -> &dyn Emit {
        self.pipeline.source().emit().expect("`new` saw it")
    }

    fn receive(&self) -> &dyn Receive {
        self.pipeline.scene.imager.receive().expect("`new` saw it")
    }

    fn state(&self, capacity: usize) -> ThreadState {
        // Polarized where that is asked for, however steep the lens is.
        let rays = RayBatch::new(capacity);
        let rays = if self.pipeline.scene.render.reflections.polarized { rays.with_polarization() } else { rays };
        let rays = if self.pipeline.draws { rays.with_numbers() } else { rays };
        ThreadState { rays, ..ThreadState::new(&self.pipeline, capacity) }
    }

    /// Puts rays `first .. first + len` of a stream on the source, with the numbers of all dimensions.
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
        self.emit().place(&mut state.rays, u.slice(len), v.slice(len), isa);
        look(Step::Source, &state.rays);
    }

    /// Takes rays that are on the source to the front, by two numbers each; says where each is aimed at.
    fn aim(&self, rays: &mut RayBatch, guides: &[Guide], numbers: [&[f64]; 2]) -> Aims {
        let Some(opening) = &self.plan.opening else { return Aims::of_numbers(numbers) };
        let [x, y, z] = rays.positions();
        let zone = |i: usize| self.plan.zones.of(DVec3::new(x[i], y[i], z[i])).min(guides.len() - 1);
        let zones = if guides.len() == 1 { vec![0; x.len()] } else { (0..x.len()).map(zone).collect() };
        let mut aims = Aims::drawn(guides, zones, numbers, self.pipeline.isa);
        if self.spreading.is_some() {
            aims.note_azimuths(rays);
        }
        aims.send(rays, *opening, self.pipeline.isa);
        aims
    }

    /// Starts rays `first .. first + len` of a stream at the front.
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
        self.emit().radiate(&mut state.rays, self.pipeline.isa);
        look(Step::Source, &state.rays);
        aims
    }

    /// From the front to the pixels. The number of each ray of the batch that it was.
    fn finish(&self, state: &mut ThreadState, route: &Route, mut look: impl FnMut(Step, &RayBatch)) -> Vec<u32> {
        let isa = self.pipeline.isa;
        (0..).zip(state.rays.columns_mut().tag).for_each(|(number, tag)| *tag = number);
        self.pipeline.tracer.follow(route, &mut state.rays, &mut state.work);
        let numbers = state.rays.tags().to_vec();
        look(Step::Lens, &state.rays);
        state.rays.set_stage(StageKey::IMAGER);
        self.receive().receive(&mut state.rays, isa);
        look(Step::Imager, &state.rays);
        state.settle(isa);
        numbers
    }

    /// Traces rays `first .. first + len` of a path; what arrived is left in the batch, pixels in the tags. Where each of them went in.
    fn batch(
        &self,
        state: &mut ThreadState,
        at: usize,
        (first, len): (u64, usize),
        mut look: impl FnMut(Step, &RayBatch),
    ) -> Vec<Landed> {
        let way = &self.plan.ways[at];
        let aims = self.start(state, &way.guides, (at as u64 + 1, first, len), &mut look);
        let numbers = self.finish(state, &way.route, &mut look);
        let alive = numbers.iter().zip(state.rays.states()).filter(|(_, state)| **state == ALIVE);
        let landed = alive.map(|(number, _)| aims.landed(*number as usize)).collect();
        state.rays.compact();
        state.rays.weighing().weight.iter_mut().for_each(|weight| *weight *= way.boost);
        landed
    }

    /// What each ray of a batch brings to each channel, ray by ray.
    fn brought(&self, state: &mut ThreadState) -> Vec<f64> {
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

    /// Sums of all paths: one a pixel and channel.
    fn cells(&self) -> usize {
        self.pipeline.scene.imager.size().pixels() * self.pipeline.recorded.len()
    }

    /// Rays of a sample, where the brightest block has so much light.
    fn rays_a_sample(&self, matters: Option<f64>, brightest: f64) -> u64 {
        let a_pixel = matters.map_or(RAYS_A_PIXEL, |matters| {
            // What matters is a part of the mean.
            RAYS_A_PIXEL * (MATTERS * brightest / matters).clamp(LEAST_A_PIXEL, 1.0)
        });
        let pixels = self.pipeline.scene.imager.size().pixels() as f64;
        ((pixels * a_pixel) as u64).max(self.plan.ways.len() as u64 * LEAST_A_PATH)
    }

    /// The rays of a sample, shared out over the paths.
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
        let way = |(((guides, _), way), count): (((Vec<Guide>, f64), &Way), &u64)| Way {
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

    /// What a unit of the sums of so many rays is worth in such a time, J/m2.
    fn worth(&self, rays: u64, time_s: f64) -> f64 {
        time_s / self.scale / self.pipeline.scene.imager.size().pixel_area_mm2() / rays.max(1) as f64
    }

    /// The scale of the sums, by some rays of each path.
    fn pilot_scale(&self, workers: &dyn Workers) -> Result<f64, RenderError> {
        let capacity = self.pipeline.scene.render.batch;
        let look = |state: &mut ThreadState, at: usize| {
            let mut largest = 0.0_f64;
            for (first, len) in spans(0..self.plan.ways[at].rays.min(SCALE_RAYS), capacity) {
                let mut blame = Blame::default();
                self.batch(state, at, (first, len), |step, rays| blame.look(step, rays));
                if blame.no_number(&self.pipeline).is_some() {
                    // Places of rays that ended in another batch are nobody's fault.
                    let (mut blame, mut again) = (Blame::default(), self.state(capacity));
                    self.batch(&mut again, at, (first, len), |step, rays| blame.look(step, rays));
                    if let Some(error) = blame.no_number(&self.pipeline) {
                        return Err(error);
                    }
                }
                largest = largest.max(state.largest(&self.pipeline));
            }
            Ok(largest)
        };
        let each = each_of(workers, self.plan.ways.len(), || self.state(capacity), look)?;
        let largest = each.into_iter().fold(0.0, f64::max);
        Ok(scale_for(largest * HEADROOM * self.pipeline.source().peak_over_mean().max(1.0)))
    }

    /// Adds a block to the sums.
    fn block(&self, state: &mut ThreadState, block: u64, sums: &ExactSums) -> Unit {
        let mut rays = 0;
        for (at, way) in self.plan.ways.iter().enumerate() {
            let all = block * way.rays..(block + 1) * way.rays;
            for (first, len) in spans(all, state.rays.capacity()) {
                let landed = self.batch(state, at, (first, len), |_, _| {});
                if !state.contributions(&self.pipeline, self.scale) {
                    let (mut blame, mut again) = (Blame::default(), self.state(state.rays.capacity()));
                    self.batch(&mut again, at, (first, len), |step, rays| blame.look(step, rays));
                    return Unit { rays, error: Some(blame.error(&self.pipeline, &mut again, self.scale)) };
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
        Unit { rays, error: None }
    }
}

impl Plan {
    /// Before rays are shared out.
    fn new(opening: Option<FrontOpening>, zones: Zones, ways: Vec<Way>) -> Self {
        let (ledger, apart) = (LightLedger::default(), Vec::new());
        Self { opening, zones, ways, rays: 1, blocks_a_sample: 1, ledger, apart }
    }

    /// With more paths, before rays are shared out.
    fn with(&self, more: Vec<Way>) -> Self {
        let ways = self.ways.iter().cloned().chain(more).collect();
        Self::new(self.opening, self.zones.clone(), ways)
    }
}

/// A span of rays in batches: the first one and the number of each.
fn spans(rays: Range<u64>, capacity: usize) -> impl Iterator<Item = (u64, usize)> {
    let end = rays.end;
    rays.step_by(capacity).map(move |first| (first, capacity.min((end - first) as usize)))
}

impl Estimator for Ghosts {
    fn name(&self) -> &'static str {
        ESTIMATOR
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

    fn reseeded(&self, picture: u64, seed: u64) -> Box<dyn Estimator> {
        let (pipeline, plan) = (Arc::new(self.pipeline.of_seed(picture)), self.plan.clone());
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

    fn run(&self, samples: &Range<u64>, _tiles: &[u32], unit: u64, scratch: &mut Scratch, sums: &ExactSums) -> Unit {
        self.block(&mut scratch.0, samples.start * self.plan.blocks_a_sample + unit, sums)
    }

    fn expected_noise(&self, samples: u64) -> Option<f64> {
        self.spreading.as_ref().map(|spreading| spreading.width.noise(samples, spreading.spreader.most_half))
    }

    fn weights(&self, _done: &Done, rays: u64, time_s: f64) -> Vec<f64> {
        let size = self.pipeline.scene.imager.size();
        vec![self.worth(rays, time_s); size.pixels()]
    }

    fn metered(&self, workers: &dyn Workers) -> Result<Vec<Vec<f64>>, RenderError> {
        self.of_meters(workers).map_or(Ok(Vec::new()), |meters| meters?.seen(workers))
    }
}
