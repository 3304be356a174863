//! Backward rendering: traces rays from each pixel through the rear of the lens and looks up the light that arrives along them.
//!
//! **One ray.** Each sample has five numbers: wavelength, place in the pixel (2), place on the pupil (2). The wavelength density turns the
//! first into a wavelength and divides the weight by its density. The imager places the ray on the film. [`RearPupil`] aims it at what
//! passes the lens and multiplies its weight by cosine, cosine and area over the square of the distance. The tracer follows it, and the
//! source multiplies by the radiance along it. The weight times each channel's response is rounded to an integer and added.
//!
//! **Core and rim.** Rays that are lost at a rim are the main source of noise. With 1 % of them lost at random, a layer of color film that
//! sees a third of the rays needs 300 rays for 1 % noise, however smooth the light is. The core and the rim of what passes are therefore
//! traced separately ([`AimPart`]). Each sample sends a ray to the core, where almost none ends. One in 16 samples of a pixel also brings a
//! ray to the rim along. That ray stands for 16 and weighs little, so it hardly matters whether it ends. Neighboring pixels bring it with
//! different samples. Rays to the rim have streams of their own and are in no count of rays.

use crate::check_pixels::{CheckPixels, PIXELS_A_CHECK};
use crate::error::RenderError;
use crate::estimator::{Estimator, Scratch, UnitResult};
use crate::finite_check::FiniteCheck;
use crate::meter;
use crate::non_finite::Step;
use crate::pilot::{self, PILOT_SEED};
use crate::pipeline::{Pipeline, SCATTER, ThreadState};
use crate::sums::{ExactSums, PILOT_RAYS};
use crate::tiles::Tiles;
use crate::{Done, Workers};
use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::batch::pixel_and_channel;
use spectra_core::frame::FrameSize;
use spectra_core::numbers::{Numbers, SampleSpan, StageKey};
use spectra_core::stage::{Launch, Radiance};
use spectra_optics::{AimPart, RIM_EVERY, RearPupil};
use spectra_scene::{LightKind, Scene};
use spectra_tracer::Travel;
use std::ops::Range;
use std::sync::Arc;

/// Largest number of samples per pixel in a unit of work.
const SAMPLES_A_UNIT: u64 = 32;

/// Estimator name from which the stages derive their own random numbers.
const ESTIMATOR: &str = "backward";
/// Estimator name from which the stages derive their own random numbers for rays to the rim of the pupil.
const RIM: &str = "rim";
/// Stream bit of rays to the rim. It keeps their random numbers apart from those of the pixel's other rays.
const RIM_STREAM: u64 = 1 << 40;
/// Stream of the random numbers that decide which samples bring a ray to the rim along.
const SHIFT_STREAM: u64 = 1 << 41;

/// Estimator that traces rays from the imager to the source.
#[derive(Clone)]
pub(crate) struct Backward {
    pipeline: Arc<Pipeline>,
    rear: Arc<RearPupil>,
    numbers: Numbers,
    /// Random numbers that decide which samples bring a ray to the rim along.
    shifts: Numbers,
    /// Scale of the sums: contributions are multiplied by it before they are rounded to integers.
    scale: f64,
    /// The check pixels, if only these are traced; the sums are then numbered by them.
    checks: Option<CheckPixels>,
}

impl Backward {
    /// Searches for the pupil that the imager sees and finds the scale of the sums.
    pub(crate) fn new(pipeline: Arc<Pipeline>, workers: &dyn Workers) -> Result<Self, RenderError> {
        let scene = &pipeline.scene;
        let launch = scene.imager.launch().ok_or(RenderError::CannotLaunch)?;
        pipeline.source().radiance().ok_or(RenderError::NoRadiance)?;
        let numbers = pipeline.numbers(PILOT_SEED);
        let shifts = numbers.as_random();
        let search = || {
            let mut rays = imager_rays(launch, scene.imager.size());
            let [x, y, z] = rays.positions();
            let points: Vec<DVec3> = (0..rays.len()).map(|i| DVec3::new(x[i], y[i], z[i])).collect();
            let grid = scene.grid;
            let band_nm = [grid.start_nm, grid.end_nm()];
            let effort = pipeline.effort;
            let rear = RearPupil::search_by(&scene.lens, &pipeline.tracer, &points, band_nm, workers, effort)?;
            rays.columns_mut().wavelength_nm.fill(grid.start_nm);
            rays.number(0, &numbers, ESTIMATOR, 0, 0);
            let aside_mm = aside_mm(launch, &rear, &rays);
            Some(if aside_mm > 0.0 { rear.widened(ROOM * aside_mm) } else { rear })
        };
        let rear = pipeline.rear_pupil(search).ok_or_else(|| RenderError::no_pupil(workers))?;
        let (pixels, seed) = (scene.imager.size().pixels() as u64, pipeline.seed);
        let mut own = Self { rear, numbers, shifts, scale: 1.0, checks: None, pipeline };
        own.scale = pilot::scale(&own.pipeline, |state, batch, mut look| {
            own.steps(state, &spread(pixels, batch), AimPart::Whole, &mut look);
        })?;
        Ok(own.with_seed(seed))
    }

    /// Returns a copy that draws from the random numbers of `seed`.
    fn with_seed(&self, seed: u64) -> Self {
        let numbers = self.pipeline.numbers(seed);
        let (pipeline, rear) = (self.pipeline.clone(), self.rear.clone());
        Self { shifts: numbers.as_random(), pipeline, rear, numbers, scale: self.scale, checks: self.checks }
    }

    /// Returns a copy that traces what the meters see, or `None` if they see none of the source's light. Its scale is 1, since it adds to
    /// no sums.
    fn of_meters(&self) -> Option<Self> {
        let pipeline = Arc::new(self.pipeline.of_meters()?);
        let (numbers, shifts) = (self.numbers.clone(), self.shifts.clone());
        Some(Self { pipeline, rear: self.rear.clone(), numbers, shifts, scale: 1.0, checks: None })
    }

    /// Estimates the mean of the frame from [`PILOT_RAYS`] rays: W/m2, summed over the channels. The result is the same for any seed of the
    /// picture.
    pub(crate) fn mean(&self) -> f64 {
        let pilot = self.with_seed(PILOT_SEED);
        let mut state = ThreadState::new(&self.pipeline, PILOT_RAYS as usize);
        pilot.steps(&mut state, &spread(self.size().pixels() as u64, 0), AimPart::Whole, &mut |_, _| {});
        state.sum(&self.pipeline) / f64::from(PILOT_RAYS)
    }

    fn launch(&self) -> &dyn Launch {
        self.pipeline.scene.imager.launch().expect("checked by `new`")
    }

    fn radiance(&self) -> &dyn Radiance {
        self.pipeline.source().radiance().expect("checked by `new`")
    }

    /// Traces samples of some pixels, pixel after pixel, through a part of the pupil. `look` sees the rays after each step. Afterwards the
    /// weights are irradiance, and 0 for rays that ended.
    #[inline(always)]
    fn steps(&self, state: &mut ThreadState, spans: &[Span], part: AimPart, look: &mut impl FnMut(Step, &RayBatch)) {
        let isa = self.pipeline.isa;
        let (name, stream) = if part == AimPart::Rim { (RIM, RIM_STREAM) } else { (ESTIMATOR, 0) };
        let len = spans.iter().map(|span| span.count).sum();
        for (dimension, column) in state.numbers.iter_mut().enumerate() {
            let stretches = spans.iter().map(|span| SampleSpan {
                stream: stream | u64::from(span.pixel),
                first: u64::from(span.first),
                count: span.count,
            });
            let (group, out) = (self.pipeline.group(dimension), column.slice_mut(len));
            self.numbers.fill_spans(isa, stretches, group, dimension as u32, out);
        }
        let start = |rays: &mut RayBatch| {
            let mut from = 0;
            for &Span { pixel, first, count, .. } in spans {
                rays.columns_mut().tag[from..from + count].fill(pixel);
                rays.number(from, &self.numbers, name, u64::from(pixel), u64::from(first));
                from += count;
            }
        };
        self.follow(state, len, part, start, look);
    }

    /// Traces `len` rays through a part of the pupil, with the random numbers in the columns of `state`. `start` writes the pixel of each
    /// ray and sets up the stages' own random numbers. `look` sees the rays after each step.
    #[inline(always)]
    pub(crate) fn follow(
        &self,
        state: &mut ThreadState,
        len: usize,
        part: AimPart,
        start: impl FnOnce(&mut RayBatch),
        look: &mut impl FnMut(Step, &RayBatch),
    ) {
        let isa = self.pipeline.isa;
        state.draw_wavelengths(&self.pipeline, len);
        look(Step::Wavelengths, &state.rays);
        start(&mut state.rays);
        state.rays.set_stage(StageKey::IMAGER);
        let [_, u, v, a, b] = &state.numbers;
        let launch = self.launch();
        launch.place(&mut state.rays, u.slice(len), v.slice(len));
        look(Step::Imager, &state.rays);
        let dark = self.rear.aim_part(&mut state.rays, a.slice(len), b.slice(len), part);
        state.drop_dark(dark);
        look(Step::Pupil, &state.rays);
        launch.admit(&mut state.rays);
        let ended = state.rays.len() - state.rays.alive();
        state.drop_dark(ended);
        look(Step::Imager, &state.rays);
        self.pipeline.tracer.trace(&mut state.rays, &mut state.work, Travel::Backward);
        look(Step::Lens, &state.rays);
        state.rays.set_stage(StageKey::SOURCE);
        self.radiance().radiance(&mut state.rays);
        look(Step::Source, &state.rays);
        state.settle(isa);
    }

    /// Adds samples of some pixels to the sums.
    ///
    /// # Errors
    /// Fails if a contribution is not a finite number or does not fit. The light of its ray is left out then.
    fn unit(
        &self,
        state: &mut ThreadState,
        pixels: &[u32],
        samples: Range<u32>,
        sums: &ExactSums,
    ) -> Result<(), RenderError> {
        let channels = state.integers.len();
        let mut local = vec![0_i64; pixels.len() * channels];
        let mut spans = Vec::with_capacity(pixels.len());
        let capacity = state.rays.capacity();
        // A batch takes as many whole pixels as it holds, or part of one pixel if it does not hold a whole one.
        let at_once = samples.len().min(capacity);
        let mut result = Ok(());
        for (begin, pixels) in (0..).step_by(capacity / at_once).zip(pixels.chunks(capacity / at_once)) {
            for first in samples.clone().step_by(at_once) {
                let count = at_once.min((samples.end - first) as usize);
                spans.clear();
                spans.extend((begin..).zip(pixels).map(|(at, pixel)| Span { at, pixel: *pixel, first, count }));
                result = result.and(self.add(state, &spans, AimPart::Core, &mut local));
            }
        }
        if self.rear.has_rim() {
            result = result.and(self.add_rim(state, pixels, samples, &mut local));
        }
        for (pixel, values) in pixels.iter().zip(local.chunks_exact(channels)) {
            if let Some(place) = self.place(*pixel) {
                let cell = place * channels;
                values.iter().enumerate().for_each(|(channel, value)| sums.add(cell + channel, *value));
            }
        }
        result
    }

    /// Returns the number of a pixel within the sums; `None` if it is not traced.
    fn place(&self, pixel: u32) -> Option<usize> {
        self.checks.map_or(Some(pixel as usize), |checks| checks.group_of(pixel as usize))
    }

    /// Returns the pixels of a tile that are traced.
    fn pixels_of(&self, tile: u32) -> impl Iterator<Item = u32> {
        let tile = self.tiling().tile(tile);
        (0..tile.len()).map(move |at| tile.pixel(at)).filter(|pixel| self.place(*pixel).is_some())
    }
}

/// Consecutive samples of one pixel.
#[derive(Clone, Copy)]
struct Span {
    /// Position of the pixel in its unit.
    at: usize,
    pixel: u32,
    first: u32,
    count: usize,
}

/// Returns [`PILOT_RAYS`] pixels spread evenly over the frame, each with the sample of this number.
fn spread(pixels: u64, sample: u32) -> Vec<Span> {
    let pixel = |i: u32| (u64::from(i) * pixels / u64::from(PILOT_RAYS)) as u32;
    (0..PILOT_RAYS).map(|i| Span { at: i as usize, pixel: pixel(i), first: sample, count: 1 }).collect()
}

impl Backward {
    /// Traces samples of a unit's pixels through a part of the pupil and adds them to the local sums of the unit.
    fn add(
        &self,
        state: &mut ThreadState,
        spans: &[Span],
        part: AimPart,
        local: &mut [i64],
    ) -> Result<(), RenderError> {
        self.steps(state, spans, part, &mut |_, _| {});
        let mut result = Ok(());
        if !state.contributions(&self.pipeline, self.scale) {
            let (losses, detected) = (state.work.losses.clone(), state.detected);
            let mut blame = FiniteCheck::default();
            self.steps(state, spans, part, &mut |step, rays| blame.look(step, rays));
            (state.work.losses, state.detected) = (losses, detected);
            result = Err(blame.error(&self.pipeline, state, self.scale));
            state.contributions_that_fit(&self.pipeline, self.scale);
        }
        // The samples of one pixel are adjacent in the batch, and pixels stand in it in the order of their spans. Rays that saw nothing
        // are no longer in it. On a mosaic, rays of one pixel may be of different channels.
        let channels = state.integers.len();
        let (mut from, mut at) = (0, 0);
        for tags in state.rays.tags().chunk_by(|a, b| a == b) {
            let (pixel, only) = pixel_and_channel(tags[0]);
            let rays = from..from + tags.len();
            from = rays.end;
            while spans[at].pixel != pixel {
                at += 1;
            }
            let cell = spans[at].at * channels;
            for (channel, integers) in state.integers.iter().enumerate() {
                if only.is_none_or(|only| only as usize == self.pipeline.recorded[channel]) {
                    local[cell + channel] += integers[rays.clone()].iter().sum::<i64>();
                }
            }
        }
        result
    }

    /// Adds rays through the rim of the pupil. In each block of [`RIM_EVERY`] samples of a pixel, one sample brings such a ray along. Which
    /// one it is differs between neighboring pixels, and each is equally likely. These rays do not count as samples, and losses and
    /// detected rays leave them out.
    fn add_rim(
        &self,
        state: &mut ThreadState,
        pixels: &[u32],
        samples: Range<u32>,
        local: &mut [i64],
    ) -> Result<(), RenderError> {
        let blocks = samples.start / RIM_EVERY..samples.end.div_ceil(RIM_EVERY);
        let shift = |block: u32| self.shifts.one(SHIFT_STREAM, u64::from(block), 0) * f64::from(RIM_EVERY);
        let shifts: Vec<u32> = blocks.clone().map(|block| shift(block) as u32).collect();
        let width = self.size().width_px;
        let with_ray = |pixel: u32, block: u32| {
            let (column, row) = (pixel % width, pixel / width);
            let shift = shifts[(block - blocks.start) as usize];
            // Neighbors take turns: steps of seven and five reach every sample of a block.
            let own = (7 * (column % RIM_EVERY) + 5 * (row % RIM_EVERY) + shift) % RIM_EVERY;
            samples.contains(&(block * RIM_EVERY + own))
        };
        // Every block except the first and the last lies entirely within the samples.
        let span = |(at, pixel): (usize, u32)| {
            let count = blocks.clone().filter(|block| with_ray(pixel, *block)).count();
            let first = blocks.start + u32::from(!with_ray(pixel, blocks.start));
            Span { at, pixel, first, count }
        };
        let (losses, detected) = (std::mem::take(&mut state.work.losses), state.detected);
        let with_rays = pixels.iter().copied().enumerate().map(span).filter(|span| span.count > 0);
        let spans: Vec<Span> = with_rays.collect();
        let mut result = Ok(());
        for spans in spans.chunks((state.rays.capacity() / blocks.len().max(1)).max(1)) {
            result = result.and(self.add(state, spans, AimPart::Rim, local));
        }
        (state.work.losses, state.detected) = (losses, detected);
        result
    }

    fn size(&self) -> FrameSize {
        self.pipeline.scene.imager.size()
    }

    /// Returns the number of tiles in a unit: one, or more if few of their pixels are traced or the span has few samples, so that a unit
    /// has enough rays.
    fn tiles_a_unit(&self, samples: &Range<u64>) -> usize {
        let pixels = if self.checks.is_some() { PIXELS_A_CHECK } else { 1 };
        pixels * (SAMPLES_A_UNIT / (samples.end - samples.start).clamp(1, SAMPLES_A_UNIT)) as usize
    }

    /// Returns the tiles and the samples of a unit.
    fn piece<'a>(&self, samples: &Range<u64>, tiles: &'a [u32], unit: u64) -> (&'a [u32], Range<u64>) {
        let each = self.tiles_a_unit(samples);
        let many = tiles.len().div_ceil(each) as u64;
        let first = samples.start + unit / many * SAMPLES_A_UNIT;
        let tile = (unit % many) as usize * each;
        (&tiles[tile..tiles.len().min(tile + each)], first..samples.end.min(first + SAMPLES_A_UNIT))
    }

    fn tiling(&self) -> Tiles {
        Tiles::of(self.size())
    }

    /// The check pixels of the picture with this seed.
    fn check_pixels(&self, seed: u64) -> CheckPixels {
        CheckPixels::of(self.size(), seed)
    }

    /// Returns how many samples each tile has.
    fn samples_of_tiles(&self, done: &Done) -> Vec<u64> {
        let tiles = self.tiles();
        let mut of_tile: Vec<u64> = (0..tiles as u32).map(|tile| done.samples_of(tile)).collect();
        if let Some((samples, units)) = done.open() {
            let active = done.active(tiles);
            for unit in units.ranges().flatten() {
                let (tiles, piece) = self.piece(samples, &active, unit);
                tiles.iter().for_each(|tile| of_tile[*tile as usize] += piece.end - piece.start);
            }
        }
        of_tile
    }
}

impl Estimator for Backward {
    fn name(&self) -> &'static str {
        if self.pipeline.scattered { SCATTER } else { "backward" }
    }

    fn light(&self) -> LightKind {
        self.pipeline.light()
    }

    fn tiles(&self) -> usize {
        self.tiling().count()
    }

    fn tile_of(&self, pixel: usize) -> usize {
        self.tiling().number_of(pixel) as usize
    }

    fn reseeded(&self, picture: &Arc<Scene>, seed: u64) -> Box<dyn Estimator> {
        let checks = self.checks.map(|_| self.check_pixels(picture.render.seed));
        Box::new(Self { pipeline: Arc::new(self.pipeline.of_picture(picture)), checks, ..self.with_seed(seed) })
    }

    fn in_check_pixels(&self) -> Option<Box<dyn Estimator>> {
        Some(Box::new(Self { checks: Some(self.check_pixels(self.pipeline.seed)), ..self.clone() }))
    }

    fn units(&self, samples: &Range<u64>, tiles: &[u32]) -> u64 {
        let groups = tiles.len().div_ceil(self.tiles_a_unit(samples)) as u64;
        groups * (samples.end - samples.start).div_ceil(SAMPLES_A_UNIT)
    }

    fn rays(&self, samples: &Range<u64>, tiles: &[u32]) -> u64 {
        let pixels = if tiles.len() == self.tiles() {
            self.checks.map_or(self.size().pixels(), CheckPixels::count) as u64
        } else {
            tiles.iter().map(|tile| self.pixels_of(*tile).count() as u64).sum()
        };
        pixels * (samples.end - samples.start)
    }

    fn scratch(&self) -> Scratch {
        Scratch(ThreadState::new(&self.pipeline, self.pipeline.scene.render.batch))
    }

    fn run(
        &self,
        samples: &Range<u64>,
        tiles: &[u32],
        unit: u64,
        scratch: &mut Scratch,
        sums: &ExactSums,
    ) -> UnitResult {
        let (tiles, samples) = self.piece(samples, tiles, unit);
        let pixels: Vec<u32> = tiles.iter().flat_map(|tile| self.pixels_of(*tile)).collect();
        let result = self.unit(&mut scratch.0, &pixels, samples.start as u32..samples.end as u32, sums);
        UnitResult { rays: pixels.len() as u64 * (samples.end - samples.start), error: result.err() }
    }

    fn weights(&self, done: &[&Done], _rays: u64, time_s: f64) -> Vec<f64> {
        let of_part: Vec<Vec<u64>> = done.iter().map(|part| self.samples_of_tiles(part)).collect();
        let weight = |samples: u64| time_s / self.scale / samples.max(1) as f64;
        let Some((own, check)) = of_part.split_first() else { return vec![weight(0); self.size().pixels()] };
        let spread = |samples: &dyn Fn(usize) -> u64| {
            self.tiling().spread(&(0..self.tiles()).map(|tile| weight(samples(tile))).collect::<Vec<f64>>())
        };
        let mut weights = spread(&|tile| own[tile]);
        if let [check] = check {
            // Check pixels have the samples of both sequences.
            let (of_both, checks) = (spread(&|tile| own[tile] + check[tile]), self.check_pixels(self.pipeline.seed));
            let both = (0..).zip(weights.iter_mut().zip(of_both));
            both.filter(|(pixel, _)| checks.group_of(*pixel).is_some()).for_each(|(_, (own, of_both))| *own = of_both);
        }
        weights
    }

    fn metered(&self, workers: &dyn Workers) -> Result<Vec<Vec<f64>>, RenderError> {
        self.of_meters().map_or(Ok(Vec::new()), |meters| {
            let follow = |state: &mut ThreadState,
                          len,
                          start: &mut dyn FnMut(&mut RayBatch),
                          mut look: &mut dyn FnMut(Step, &RayBatch)| {
                meters.follow(state, len, AimPart::Whole, start, &mut look);
            };
            meter::backward(&meters.pipeline, (ESTIMATOR, &follow), workers)
        })
    }
}

/// Returns rays at points all over the imager, including its edges and corners. They give its outline for the pupil search.
fn imager_rays(launch: &dyn Launch, size: FrameSize) -> RayBatch {
    const SIDE: u32 = 65;
    let mut rays = RayBatch::new((SIDE * SIDE) as usize).with_numbers();
    rays.restart((SIDE * SIDE) as usize);
    // Returns the pixel at step `k` from one edge of the frame to the other, and the position within the pixel.
    let split = |k: u32, pixels: u32| {
        let at = f64::from(k) / f64::from(SIDE - 1) * f64::from(pixels);
        let pixel = (at as u32).min(pixels - 1);
        (pixel, at - f64::from(pixel))
    };
    let (mut u, mut v) = (Vec::new(), Vec::new());
    for (i, tag) in rays.columns_mut().tag.iter_mut().enumerate() {
        let (column, x) = split(i as u32 % SIDE, size.width_px);
        let (row, y) = split(i as u32 / SIDE, size.height_px);
        *tag = row * size.width_px + column;
        u.push(x);
        v.push(y);
    }
    launch.place(&mut rays, &u, &v);
    rays
}

/// Margin on the measured sideways shift, because rays that were not measured may be shifted further.
const ROOM: f64 = 1.25;

/// Measures how far the imager shifts rays sideways after they were aimed, mm. Takes the largest shift of rays from all over the imager
/// through the middle and four sides of the pupil.
fn aside_mm(launch: &dyn Launch, rear: &RearPupil, points: &RayBatch) -> f64 {
    let mut most = 0.0_f64;
    for (u, v) in [(0.5, 0.5), (0.02, 0.5), (0.98, 0.5), (0.5, 0.02), (0.5, 0.98)] {
        let mut rays = points.clone();
        let n = rays.len();
        rear.aim(&mut rays, &vec![u; n], &vec![v; n]);
        let before = rays.clone();
        rays.set_stage(StageKey::IMAGER);
        launch.admit(&mut rays);
        let at = |rays: &RayBatch, i: usize| DVec3::from_array(rays.positions().map(|c| c[i]));
        for i in (0..n).filter(|i| before.loss(*i).is_none()) {
            let way = DVec3::from_array(rays.directions().map(|c| c[i]));
            let moved = at(&rays, i) - at(&before, i);
            most = most.max((moved - moved.dot(way) * way).length());
        }
    }
    most
}
