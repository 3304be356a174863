//! Forward: paths from the source, splatted where they land.

use crate::blame::{Blame, Step};
use crate::error::RenderError;
use crate::pipeline::{Pipeline, ThreadState};
use crate::sums::ExactSums;
use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::batch::pixel_and_channel;
use spectra_core::numbers::{Dimension, Numbers, StageKey};
use spectra_core::stage::{Emit, Receive};
use spectra_lens::{AimPattern, FrontPupil, Travel};
use spectra_scene::ConePattern;

/// Paths a unit of work: some milliseconds.
pub(crate) const PATHS_PER_UNIT: u64 = 1 << 16;
/// All forward paths form one stream of numbers.
const STREAM: u64 = 0;
/// What numbers of its own stages draw by.
const ESTIMATOR: &str = "forward";

pub(crate) struct Forward<'a> {
    pub pipeline: Pipeline<'a>,
    emit: &'a dyn Emit,
    receive: &'a dyn Receive,
    /// Where light goes in; `None` for a source that sets its directions itself.
    pupil: Option<FrontPupil>,
    numbers: Numbers,
    cone: Numbers,
}

/// Source points that are looked at before the pupil is searched.
const SOURCE_POINTS: usize = 4096;

impl<'a> Forward<'a> {
    pub(crate) fn new(mut pipeline: Pipeline<'a>, seed: u64) -> Result<Self, RenderError> {
        let scene = pipeline.scene;
        let emit = scene.source.emit().ok_or(RenderError::CannotEmit)?;
        let receive = scene.imager.receive().ok_or(RenderError::CannotReceive)?;
        pipeline.draws |= emit.draws() || receive.draws();
        let (numbers, cone) = Self::numbers(&pipeline, seed);
        let pupil = if emit.is_directed() {
            None
        } else {
            let points = source_points(&pipeline, emit, &numbers);
            let grid = scene.grid;
            let pupil = FrontPupil::search(&scene.lens, &pipeline.tracer, &points, grid.start_nm, grid.end_nm());
            Some(pupil.ok_or(RenderError::NoAperture)?)
        };
        Ok(Self { emit, receive, pupil, numbers, cone, pipeline })
    }

    /// The same with the numbers of another seed.
    pub(crate) fn reseeded(self, seed: u64) -> Self {
        let (numbers, cone) = Self::numbers(&self.pipeline, seed);
        Self { numbers, cone, ..self }
    }

    /// The numbers of a path, and those of its place on the pupil.
    fn numbers(pipeline: &Pipeline<'_>, seed: u64) -> (Numbers, Numbers) {
        let numbers = pipeline.numbers(seed);
        let random = pipeline.scene.render.cone == ConePattern::Random;
        let cone = if random { numbers.as_random() } else { numbers.clone() };
        (numbers, cone)
    }

    /// Traces paths `first .. first + len`; what arrived is left in the batch, pixels in the tags.
    pub(crate) fn batch(&self, state: &mut ThreadState, first: u64, len: usize) {
        self.steps(state, first, len, &mut |_, _| {});
    }

    /// The same, with a look at the rays after each step.
    #[inline(always)]
    pub(crate) fn steps(
        &self,
        state: &mut ThreadState,
        first: u64,
        len: usize,
        look: &mut impl FnMut(Step, &RayBatch),
    ) {
        let isa = self.pipeline.isa;
        for (dimension, column) in state.numbers.iter_mut().enumerate() {
            let numbers = if dimension >= Dimension::PupilU as usize { &self.cone } else { &self.numbers };
            let group = self.pipeline.group(dimension);
            numbers.fill_rotated(isa, STREAM, first, group, dimension as u32, column.slice_mut(len));
        }
        state.draw_wavelengths(&self.pipeline, len);
        look(Step::Wavelengths, &state.rays);
        state.rays.number(0, &self.numbers, ESTIMATOR, STREAM, first);
        state.rays.set_stage(StageKey::SOURCE);
        let [_, u, v, a, b] = &state.numbers;
        self.emit.place(&mut state.rays, u.slice(len), v.slice(len), isa);
        look(Step::Source, &state.rays);
        let rings = self.pipeline.scene.render.cone == ConePattern::Rings;
        let pattern = if rings { AimPattern::Rings } else { AimPattern::Disk };
        if let Some(pupil) = &self.pupil {
            let dark = pupil.aim(&mut state.rays, a.slice(len), b.slice(len), pattern, isa);
            state.drop_dark(dark);
            look(Step::Pupil, &state.rays);
        }
        self.emit.radiate(&mut state.rays, isa);
        look(Step::Source, &state.rays);
        self.pipeline.tracer.trace(&mut state.rays, &mut state.work, Travel::Forward);
        look(Step::Lens, &state.rays);
        state.rays.set_stage(StageKey::IMAGER);
        self.receive.receive(&mut state.rays, isa);
        look(Step::Imager, &state.rays);
        state.settle(isa);
        state.rays.compact();
    }

    /// Adds a unit of paths to the sums. Gives the number of paths added, and why they are not all, where a contribution is
    /// no number or does not fit.
    pub(crate) fn unit(
        &self,
        state: &mut ThreadState,
        first: u64,
        paths: u64,
        scale: f64,
        sums: &ExactSums,
    ) -> (u64, Option<RenderError>) {
        let batch = state.rays.capacity() as u64;
        let channels = state.integers.len();
        let mut at = first;
        while at < first + paths {
            let len = batch.min(first + paths - at);
            self.batch(state, at, len as usize);
            if !state.contributions(&self.pipeline, scale) {
                let mut blame = Blame::default();
                self.steps(state, at, len as usize, &mut |step, rays| blame.look(step, rays));
                return (at - first, Some(blame.error(&self.pipeline, state, scale)));
            }
            for (i, tag) in state.rays.tags().iter().enumerate() {
                let (pixel, only) = pixel_and_channel(*tag);
                let cell = pixel as usize * channels;
                for (channel, integers) in state.integers.iter().enumerate() {
                    if only.is_none_or(|only| only as usize == channel) {
                        sums.add(cell + channel, integers[i]);
                    }
                }
            }
            at += len;
        }
        (paths, None)
    }
}

/// Some points of a source, as the search of the pupil needs them.
fn source_points(pipeline: &Pipeline<'_>, emit: &dyn Emit, numbers: &Numbers) -> Vec<DVec3> {
    let isa = pipeline.isa;
    let mut state = ThreadState::new(pipeline, SOURCE_POINTS);
    for (dimension, column) in state.numbers.iter_mut().enumerate() {
        numbers.fill(isa, STREAM, 0, dimension as u32, column.slice_mut(SOURCE_POINTS));
    }
    state.draw_wavelengths(pipeline, SOURCE_POINTS);
    state.rays.number(0, numbers, ESTIMATOR, STREAM, 0);
    state.rays.set_stage(StageKey::SOURCE);
    let [_, u, v, _, _] = &state.numbers;
    emit.place(&mut state.rays, u.slice(SOURCE_POINTS), v.slice(SOURCE_POINTS), isa);
    let [x, y, z] = state.rays.positions();
    (0..SOURCE_POINTS).map(|i| DVec3::new(x[i], y[i], z[i])).collect()
}
