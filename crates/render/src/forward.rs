//! Forward rendering: traces paths from the source and adds their light where it lands.
//!
//! **One ray.** The source places the ray (`Emit::place`), [`FrontPupil`] aims it at the real entrance pupil, and the source gives it its
//! light (`Emit::radiate`). The tracer follows it, and the imager finds its pixel (`Receive::receive`).
//!
//! **Number of rays.** If bright lights are traced apart from the rest, they get enough rays for each pixel that they reach to receive 12
//! per sample. A census of 65 536 trial rays finds how many pixels these are. One ray would not be enough: the samples of a backward pixel
//! fill the pupil evenly, but rays from a light land at random.

use crate::error::RenderError;
use crate::estimator::{Estimator, Scratch, UnitResult};
use crate::finite_check::FiniteCheck;
use crate::meter;
use crate::non_finite::Step;
use crate::pilot::{self, PILOT_SEED};
use crate::pipeline::{Pipeline, SCATTER, SourcePart, ThreadState};
use crate::scattered_light::Haze;
use crate::spots::{Land, PLACES, Spots};
use crate::sums::{ExactSums, OwnSums, PILOT_RAYS};
use crate::{Done, Workers};
use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::batch::pixel_and_channel;
use spectra_core::numbers::{Dimension, Numbers, StageKey};
use spectra_core::stage::{Emit, Receive};
use spectra_optics::{AimPattern, FrontPupil};
use spectra_scene::{ConePattern, LightKind, Scene};
use spectra_tracer::Travel;
use std::ops::Range;
use std::sync::Arc;

/// Number of paths in a unit of work, which takes some milliseconds.
const PATHS_PER_UNIT: u64 = 1 << 16;
/// All forward paths draw from one stream of random numbers.
const STREAM: u64 = 0;

/// Estimator name from which the stages derive their own random numbers.
pub(crate) const ESTIMATOR: &str = "forward";

/// Estimator that traces rays from the source to the imager.
pub(crate) struct Forward {
    pipeline: Arc<Pipeline>,
    /// Entrance pupil at which rays are aimed; `None` if the source sets their directions itself.
    pupil: Option<Arc<FrontPupil>>,
    /// Random numbers of the wavelength and of the point on the source.
    numbers: Numbers,
    /// Random numbers of the point on the pupil.
    cone: Numbers,
    /// How the lens images the spots of the source, if it consists of spots and each ray stands for a whole one.
    spots: Option<Arc<Spots>>,
    /// How light that the lens scatters is spread, if this estimator traces that light.
    haze: Option<Arc<Haze>>,
    /// Scale of the sums: contributions are multiplied by it before they are rounded to integers.
    scale: f64,
    /// Rays per sample of all pixels together, if the scene does not state the total number of rays.
    a_sample: Option<u64>,
}

/// Rays of lights for each sample of a pixel that they reach, if the scene does not state the number of rays. One would not be enough: the
/// samples of a backward pixel fill the pupil evenly, but rays from a light land at random.
const LIGHTS_A_SAMPLE: f64 = 12.0;
/// Rays for each sample of a pixel for light that haze scatters. Fewer are enough, because the light of each ray is spread over many
/// pixels.
const HAZE_A_SAMPLE: f64 = 2.0;
/// Number of trial rays that find where the lights land.
const CENSUS: usize = 1 << 16;
/// Parts of the frame, across and down, in which the trial rays are counted.
const PARTS: [usize; 2] = [48, 32];
/// Smallest number of rays of lights per pixel and sample.
const LEAST_LIGHTS: f64 = 0.125;
/// Largest number of rays of lights per pixel and sample.
const MOST_LIGHTS: f64 = 32.0;

/// Source points from which the pupil is searched.
const SOURCE_POINTS: usize = 4096;

impl Forward {
    /// Searches for the pupil that the source sees and finds the scale of the sums.
    pub(crate) fn new(pipeline: Arc<Pipeline>, workers: &dyn Workers) -> Result<Self, RenderError> {
        let seed = pipeline.seed;
        let mut own = Self::aimed(pipeline, workers)?;
        if own.pipeline.share == SourcePart::Lights && !own.pipeline.scene.render.rays_stated {
            own.a_sample = Some(own.lights_a_sample());
        }
        if Haze::suits(&own.pipeline) {
            own.haze = Haze::of(&own.pipeline, &own.aimed_rays(false))?.map(Arc::new);
        } else if !own.pipeline.scattered {
            own.spots = own.spots().map(Arc::new);
        }
        own.scaled(seed)
    }

    /// Returns the number of rays of lights for one sample of all pixels: enough to give each pixel that they reach [`LIGHTS_A_SAMPLE`], or
    /// [`HAZE_A_SAMPLE`] of light scattered by haze.
    fn lights_a_sample(&self) -> u64 {
        let size = self.pipeline.scene.imager.size();
        let sides = [size.width_px as usize, size.height_px as usize];
        let parts = [PARTS[0].min(sides[0]), PARTS[1].min(sides[1])];
        let mut counts = vec![0_u64; parts[0] * parts[1]];
        let mut state = ThreadState::new(&self.pipeline, PILOT_RAYS as usize);
        for first in (0..CENSUS).step_by(PILOT_RAYS as usize) {
            self.batch(&mut state, first as u64, PILOT_RAYS as usize);
            for (tag, weight) in state.rays.tags().iter().zip(state.rays.weights()) {
                let pixel = pixel_and_channel(*tag).0 as usize;
                let (column, row) = (pixel % sides[0] * parts[0] / sides[0], pixel / sides[0] * parts[1] / sides[1]);
                counts[row * parts[0] + column] += u64::from(*weight != 0.0);
            }
        }
        let landed: u64 = counts.iter().sum();
        // The probability that two rays land in the same part tells how many parts they share.
        let pairs: u64 = counts.iter().map(|n| n * n.saturating_sub(1)).sum();
        let pixels = size.pixels() as f64;
        let a_pixel = if landed == 0 {
            LEAST_LIGHTS
        } else {
            let landed = landed as f64;
            let reached = if pairs > 0 { landed * (landed - 1.0) / pairs as f64 / counts.len() as f64 } else { 1.0 };
            let a_sample = if Haze::suits(&self.pipeline) { HAZE_A_SAMPLE } else { LIGHTS_A_SAMPLE };
            let each = a_sample * reached.min(1.0) * CENSUS as f64 / landed;
            each.clamp(LEAST_LIGHTS, MOST_LIGHTS)
        };
        ((a_pixel * pixels) as u64).max(1)
    }

    /// Finds the scale of the sums by a pilot, then takes the random numbers of `seed`.
    fn scaled(mut self, seed: u64) -> Result<Self, RenderError> {
        (self.numbers, self.cone) = Self::numbers(&self.pipeline, PILOT_SEED);
        self.scale = pilot::scale(&self.pipeline, |state, batch, mut look| {
            self.steps(state, u64::from(batch * PILOT_RAYS), PILOT_RAYS as usize, &mut look);
        })?;
        (self.numbers, self.cone) = Self::numbers(&self.pipeline, seed);
        Ok(self)
    }

    /// Returns a copy that traces what the meters see, or `None` if they see none of the source's light.
    fn of_meters(&self) -> Option<Result<Self, RenderError>> {
        let pipeline = Arc::new(self.pipeline.of_meters()?);
        let (numbers, cone) = (self.numbers.clone(), self.cone.clone());
        let seed = pipeline.seed ^ meter::SEED;
        let pupil = self.pupil.clone();
        Some(Self { pupil, numbers, cone, spots: None, haze: None, scale: 1.0, pipeline, a_sample: None }.scaled(seed))
    }

    /// Searches for the pupil. The result draws from the random numbers of the pilot and has no scale yet.
    pub(crate) fn aimed(pipeline: Arc<Pipeline>, workers: &dyn Workers) -> Result<Self, RenderError> {
        let scene = &pipeline.scene;
        let emit = pipeline.source().emit().ok_or(RenderError::CannotEmit)?;
        scene.imager.receive().ok_or(RenderError::CannotReceive)?;
        let (numbers, cone) = Self::numbers(&pipeline, PILOT_SEED);
        let pupil = if emit.is_directed() {
            None
        } else {
            let points = source_points(&pipeline, emit, &numbers);
            let grid = scene.grid;
            let band_nm = [grid.start_nm, grid.end_nm()];
            let effort = pipeline.effort;
            let pupil = FrontPupil::search_by(&scene.lens, &pipeline.tracer, &points, band_nm, workers, effort);
            Some(Arc::new(pupil.ok_or_else(|| RenderError::no_pupil(workers))?))
        };
        Ok(Self { pupil, numbers, cone, spots: None, haze: None, scale: 1.0, pipeline, a_sample: None })
    }

    /// Measures how the lens images the spots of the source; `None` if the source has none or their light cannot be spread.
    fn spots(&self) -> Option<Spots> {
        let half_mm = self.emit().spots_mm()?;
        let planes_mm = [-self.pipeline.source().distance_mm(), self.pupil.as_ref()?.eye_z_mm()];
        let pixel_mm = self.pipeline.scene.imager.size().pixel_area_mm2().sqrt();
        Spots::look(half_mm, planes_mm, &self.aimed_rays(true), &self.pipeline.tracer, pixel_mm)
    }

    /// Returns [`PILOT_RAYS`] aimed rays, drawn from the current random numbers. They start in the middle of spots if `in_middle` is true.
    fn aimed_rays(&self, in_middle: bool) -> RayBatch {
        let mut state = ThreadState::new(&self.pipeline, PILOT_RAYS as usize);
        self.aim(&mut state, 0, PILOT_RAYS as usize, in_middle, &mut |_, _| {});
        state.rays
    }

    fn emit(&self) -> &dyn Emit {
        self.pipeline.source().emit().expect("checked by `aimed`")
    }

    fn receive(&self) -> &dyn Receive {
        self.pipeline.scene.imager.receive().expect("checked by `aimed`")
    }

    /// Returns the random numbers of a path and those of its point on the pupil.
    fn numbers(pipeline: &Pipeline, seed: u64) -> (Numbers, Numbers) {
        let numbers = pipeline.numbers(seed);
        let random = pipeline.scene.render.cone == ConePattern::Random;
        let cone = if random { numbers.as_random() } else { numbers.clone() };
        (numbers, cone)
    }

    /// Traces paths `first .. first + len`. Rays that arrived are left in the batch, with their pixels in the tags.
    fn batch(&self, state: &mut ThreadState, first: u64, len: usize) {
        self.steps(state, first, len, &mut |_, _| {});
    }

    /// Traces paths `first .. first + len` and lets `look` see the rays after each step. Rays that arrived are left in the batch.
    #[inline(always)]
    pub(crate) fn steps(
        &self,
        state: &mut ThreadState,
        first: u64,
        len: usize,
        look: &mut impl FnMut(Step, &RayBatch),
    ) {
        self.lens_steps(state, first, len, self.spots.is_some(), look);
        self.arrive(state, look);
        state.rays.compact();
    }

    #[inline(always)]
    fn lens_steps(
        &self,
        state: &mut ThreadState,
        first: u64,
        len: usize,
        in_middle: bool,
        look: &mut impl FnMut(Step, &RayBatch),
    ) {
        self.aim(state, first, len, in_middle, look);
        self.pipeline.tracer.trace(&mut state.rays, &mut state.work, Travel::Forward);
        look(Step::Lens, &state.rays);
    }

    #[inline(always)]
    fn arrive(&self, state: &mut ThreadState, look: &mut impl FnMut(Step, &RayBatch)) {
        let isa = self.pipeline.isa;
        state.rays.set_stage(StageKey::IMAGER);
        self.receive().receive(&mut state.rays);
        look(Step::Imager, &state.rays);
        state.settle(isa);
    }

    #[inline(always)]
    fn aim(
        &self,
        state: &mut ThreadState,
        first: u64,
        len: usize,
        in_middle: bool,
        look: &mut impl FnMut(Step, &RayBatch),
    ) {
        let isa = self.pipeline.isa;
        for (dimension, column) in state.numbers.iter_mut().enumerate() {
            let numbers = if dimension >= Dimension::PupilU as usize { &self.cone } else { &self.numbers };
            let group = self.pipeline.group(dimension);
            numbers.fill_rotated(isa, STREAM, first, group, dimension as u32, column.slice_mut(len));
        }
        state.draw_wavelengths(&self.pipeline, len);
        (0..).zip(state.rays.columns_mut().tag).for_each(|(number, tag)| *tag = number);
        look(Step::Wavelengths, &state.rays);
        state.rays.number(0, &self.numbers, ESTIMATOR, STREAM, first);
        state.rays.set_stage(StageKey::SOURCE);
        let [_, u, v, a, b] = &state.numbers;
        let emit = self.emit();
        if in_middle {
            emit.place_in_middle(&mut state.rays, u.slice(len), v.slice(len));
        } else {
            emit.place(&mut state.rays, u.slice(len), v.slice(len));
        }
        look(Step::Source, &state.rays);
        let rings = self.pipeline.scene.render.cone == ConePattern::Rings;
        let pattern = if rings { AimPattern::Rings } else { AimPattern::Disk };
        if let Some(pupil) = &self.pupil {
            let dark = pupil.aim(&mut state.rays, a.slice(len), b.slice(len), pattern);
            state.drop_dark(dark);
            look(Step::Pupil, &state.rays);
        }
        emit.radiate(&mut state.rays);
        let ended = state.rays.len() - state.rays.alive();
        state.drop_dark(ended);
        look(Step::Source, &state.rays);
    }

    /// Adds a unit of paths to the sums. Returns the number of paths, and an error if a contribution is not finite or does not fit; the
    /// light of such paths is left out.
    pub(crate) fn unit(
        &self,
        state: &mut ThreadState,
        first: u64,
        paths: u64,
        sums: &ExactSums,
    ) -> (u64, Option<RenderError>) {
        let batch = state.rays.capacity() as u64;
        let (mut at, mut failure) = (first, None);
        while at < first + paths {
            let len = batch.min(first + paths - at);
            let is_good = match (&self.spots, &self.haze) {
                (Some(spots), _) => self.spread(state, at, len as usize, spots, sums),
                (None, Some(haze)) => self.scatter(state, at, len as usize, haze, sums),
                (None, None) => {
                    self.batch(state, at, len as usize);
                    self.add(state, sums)
                }
            };
            if !is_good && failure.is_none() {
                // Trace in a fresh state: positions left over from rays that ended in another batch must not be blamed.
                let mut blame = FiniteCheck::default();
                let mut again = ThreadState::new(&self.pipeline, state.rays.capacity());
                self.steps(&mut again, at, len as usize, &mut |step, rays| blame.look(step, rays));
                failure = Some(blame.error(&self.pipeline, &mut again, self.scale));
            }
            at += len;
        }
        (paths, failure)
    }

    /// Adds the contributions of a batch to the sums. Returns false if one is not finite or does not fit; its ray adds nothing then.
    fn add(&self, state: &mut ThreadState, sums: &ExactSums) -> bool {
        let is_good = state.contributions(&self.pipeline, self.scale);
        if !is_good {
            state.contributions_that_fit(&self.pipeline, self.scale);
        }
        let (tags, recorded) = (state.rays.tags(), &self.pipeline.recorded[..]);
        match &mut state.own {
            Some(own) => own.add(tags, &state.integers, recorded, sums),
            None => sums.add_rays(0, tags, &state.integers, recorded),
        }
        is_good
    }

    /// Traces paths like [`Forward::batch`] and adds the light of each to all the places over which it is spread. Each path is counted
    /// once.
    fn spread(&self, state: &mut ThreadState, first: u64, len: usize, spots: &Spots, sums: &ExactSums) -> bool {
        self.lens_steps(state, first, len, true, &mut |_, _| {});
        state.rays.compact();
        let mut before = std::mem::take(&mut state.before);
        spots.keep(&state.rays, &mut before);
        let mut is_good = true;
        for number in 0..PLACES {
            let booked = (number > 0).then(|| (state.work.losses.clone(), state.detected));
            self.pipeline.isa.run(Land { number, before: &before, rays: &mut state.rays });
            self.arrive(state, &mut |_, _| {});
            is_good &= self.add(state, sums);
            if let Some((losses, detected)) = booked {
                (state.work.losses, state.detected) = (losses, detected);
            }
        }
        state.before = before;
        is_good
    }

    /// Traces paths like [`Forward::batch`] and spreads the light of each over a fraction of the distance by which scattering moved it.
    fn scatter(&self, state: &mut ThreadState, first: u64, len: usize, haze: &Haze, sums: &ExactSums) -> bool {
        self.aim(state, first, len, false, &mut |_, _| {});
        let numbers = state.rays.tags().to_vec();
        (0..).zip(state.rays.columns_mut().tag).for_each(|(at, tag)| *tag = at);
        let unscattered = haze.unscattered(&state.rays);
        self.pipeline.tracer.trace(&mut state.rays, &mut state.work, Travel::Forward);
        state.rays.compact();
        let (left, moved_px) = (state.rays.tags().to_vec(), haze.moved_px(&state.rays, &unscattered));
        let number = |i: usize| first + u64::from(numbers[left[i] as usize]);
        self.arrive(state, &mut |_, _| {});
        let is_good = state.contributions(&self.pipeline, self.scale);
        if !is_good {
            state.contributions_that_fit(&self.pipeline, self.scale);
        }
        let footprint = |i: usize| haze.footprint(moved_px[i], self.sample_of(number(i)));
        haze.spreader.add(state, footprint, None, sums);
        is_good
    }

    /// Returns the sample that a path belongs to.
    fn sample_of(&self, path: u64) -> u64 {
        let render = &self.pipeline.scene.render;
        match self.a_sample {
            Some(rays) => path / rays,
            None => (u128::from(path) * u128::from(render.samples) / u128::from(render.rays.max(1))) as u64,
        }
    }
}

impl Forward {
    /// Returns the paths of a span of samples. The rays that the scene states are divided over all its samples.
    fn paths(&self, samples: &Range<u64>) -> Range<u64> {
        let render = &self.pipeline.scene.render;
        if let Some(rays) = self.a_sample {
            return samples.start.saturating_mul(rays)..samples.end.saturating_mul(rays);
        }
        let upto = |sample: u64| {
            (u128::from(render.rays) * u128::from(sample) / u128::from(render.samples)).min(u64::MAX.into()) as u64
        };
        upto(samples.start)..upto(samples.end)
    }
}

impl Estimator for Forward {
    fn name(&self) -> &'static str {
        if self.pipeline.scattered { SCATTER } else { ESTIMATOR }
    }

    fn light(&self) -> LightKind {
        self.pipeline.light()
    }

    fn tiles(&self) -> usize {
        1
    }

    fn tile_of(&self, _pixel: usize) -> usize {
        0
    }

    fn reseeded(&self, picture: &Arc<Scene>, seed: u64) -> Box<dyn Estimator> {
        let (numbers, cone) = Self::numbers(&self.pipeline, seed);
        let (pipeline, pupil) = (Arc::new(self.pipeline.of_picture(picture)), self.pupil.clone());
        let (spots, haze, scale, a_sample) = (self.spots.clone(), self.haze.clone(), self.scale, self.a_sample);
        Box::new(Self { pipeline, pupil, numbers, cone, spots, haze, scale, a_sample })
    }

    fn units(&self, samples: &Range<u64>, tiles: &[u32]) -> u64 {
        self.rays(samples, tiles).div_ceil(PATHS_PER_UNIT)
    }

    fn rays(&self, samples: &Range<u64>, tiles: &[u32]) -> u64 {
        let paths = self.paths(samples);
        if tiles.is_empty() { 0 } else { paths.end - paths.start }
    }

    fn scratch(&self) -> Scratch {
        let mut state = ThreadState::new(&self.pipeline, self.pipeline.scene.render.batch);
        match &self.haze {
            Some(haze) => state.steps = haze.spreader.steps(),
            None => state.own = OwnSums::new(self.pipeline.scene.imager.size().pixels() * self.pipeline.recorded.len()),
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
        let paths = self.paths(samples);
        let first = paths.start + unit * PATHS_PER_UNIT;
        let (rays, error) = self.unit(&mut scratch.0, first, PATHS_PER_UNIT.min(paths.end - first), sums);
        UnitResult { rays, error }
    }

    fn weights(&self, _done: &[&Done], rays: u64, time_s: f64) -> Vec<f64> {
        let size = self.pipeline.scene.imager.size();
        vec![time_s / self.scale / size.pixel_area_mm2() / rays.max(1) as f64; size.pixels()]
    }

    fn metered(&self, workers: &dyn Workers) -> Result<Vec<Vec<f64>>, RenderError> {
        self.of_meters().map_or(Ok(Vec::new()), |meters| {
            let meters = meters?;
            let unit =
                |state: &mut ThreadState, first, paths, sums: &ExactSums| meters.unit(state, first, paths, sums).1;
            meter::forward(&meters.pipeline, meters.scale, (PATHS_PER_UNIT, &unit), workers)
        })
    }
}

/// Returns some points of the source, from which the pupil is searched.
pub(crate) fn source_points(pipeline: &Pipeline, emit: &dyn Emit, numbers: &Numbers) -> Vec<DVec3> {
    let isa = pipeline.isa;
    let mut state = ThreadState::new(pipeline, SOURCE_POINTS);
    for (dimension, column) in state.numbers.iter_mut().enumerate() {
        numbers.fill(isa, STREAM, 0, dimension as u32, column.slice_mut(SOURCE_POINTS));
    }
    state.draw_wavelengths(pipeline, SOURCE_POINTS);
    state.rays.number(0, numbers, ESTIMATOR, STREAM, 0);
    state.rays.set_stage(StageKey::SOURCE);
    let [_, u, v, _, _] = &state.numbers;
    emit.place(&mut state.rays, u.slice(SOURCE_POINTS), v.slice(SOURCE_POINTS));
    let [x, y, z] = state.rays.positions();
    (0..SOURCE_POINTS).map(|i| DVec3::new(x[i], y[i], z[i])).collect()
}
