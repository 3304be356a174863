//! Backward: each pixel asks, through the rear of the lens, what light arrives.

use crate::blame::Blame;
use crate::error::RenderError;
use crate::estimator::{Estimator, Scratch, Unit};
use crate::meter;
use crate::no_number::Step;
use crate::pilot::{self, PILOT_SEED};
use crate::pipeline::{Pipeline, SCATTER, ThreadState};
use crate::sums::{ExactSums, PILOT_RAYS};
use crate::{Done, Workers};
use glam::DVec3;
use spectra_core::Isa;
use spectra_core::RayBatch;
use spectra_core::batch::pixel_and_channel;
use spectra_core::frame::FrameSize;
use spectra_core::numbers::{Numbers, StageKey};
use spectra_core::stage::{Launch, Radiance};
use spectra_lens::{RearPupil, Travel};
use std::ops::Range;
use std::sync::Arc;

/// Side of a tile, the pixels of a unit of work: blocks that noise is judged by consist of whole ones.
pub(crate) const TILE: u32 = 8;
/// Samples of each pixel in a unit of work.
pub(crate) const SAMPLES_PER_PASS: u32 = 32;

/// What numbers of its own stages draw by.
const ESTIMATOR: &str = "backward";

pub(crate) struct Backward {
    pipeline: Arc<Pipeline>,
    rear: Arc<RearPupil>,
    numbers: Numbers,
    /// Of the sums.
    scale: f64,
}

impl Backward {
    /// Searches what passes the lens, and finds the scale of the sums.
    pub(crate) fn new(pipeline: Arc<Pipeline>, workers: &dyn Workers) -> Result<Self, RenderError> {
        let scene = &pipeline.scene;
        let launch = scene.imager.launch().ok_or(RenderError::CannotLaunch)?;
        pipeline.source().radiance().ok_or(RenderError::NoRadiance)?;
        let mut rays = imager_rays(launch, scene.imager.size(), pipeline.isa);
        let [x, y, z] = rays.positions();
        let points: Vec<DVec3> = (0..rays.len()).map(|i| DVec3::new(x[i], y[i], z[i])).collect();
        let grid = scene.grid;
        let band_nm = [grid.start_nm, grid.end_nm()];
        let effort = pipeline.effort;
        let rear = RearPupil::search_by(&scene.lens, &pipeline.tracer, &points, band_nm, workers, effort);
        let numbers = pipeline.numbers(PILOT_SEED);
        let rear = rear.map(|rear| {
            rays.columns_mut().wavelength_nm.fill(grid.start_nm);
            rays.number(0, &numbers, ESTIMATOR, 0, 0);
            let aside_mm = aside_mm(launch, &rear, &rays, pipeline.isa);
            if aside_mm > 0.0 { rear.widened(ROOM * aside_mm) } else { rear }
        });
        let pixels = scene.imager.size().pixels() as u64;
        let (rear, seed) = (Arc::new(rear.ok_or_else(|| RenderError::no_pupil(workers))?), scene.render.seed);
        let mut own = Self { rear, numbers, scale: 1.0, pipeline };
        own.scale = pilot::scale(&own.pipeline, |state, batch, mut look| {
            let spread = (0..PILOT_RAYS).map(|i| (u64::from(i) * pixels / u64::from(PILOT_RAYS)) as u32);
            own.steps(state, spread, batch, 1, &mut look);
        })?;
        own.numbers = own.pipeline.numbers(seed);
        Ok(own)
    }

    /// The same for what the meters see, which has no sums; `None` where they see nothing.
    fn of_meters(&self) -> Option<Self> {
        let pipeline = Arc::new(self.pipeline.of_meters()?);
        Some(Self { pipeline, rear: self.rear.clone(), numbers: self.numbers.clone(), scale: 1.0 })
    }

    /// The mean of the frame, W/m2 in the sum of its channels, by a few thousand rays.
    pub(crate) fn mean(&self) -> f64 {
        let pixels = self.pipeline.scene.imager.size().pixels() as u64;
        let spread = (0..PILOT_RAYS).map(|i| (u64::from(i) * pixels / u64::from(PILOT_RAYS)) as u32);
        let mut state = ThreadState::new(&self.pipeline, PILOT_RAYS as usize);
        self.batch(&mut state, spread, 0, 1);
        state.sum(&self.pipeline) / f64::from(PILOT_RAYS)
    }

    fn launch(&self) -> &dyn Launch {
        self.pipeline.scene.imager.launch().expect("`new` saw it")
    }

    fn radiance(&self) -> &dyn Radiance {
        self.pipeline.source().radiance().expect("`new` saw it")
    }

    /// Traces `count` samples, from `first` on, of each of `pixels`: pixel after pixel. Afterwards
    /// the weights are irradiance, and 0 for rays that ended.
    fn batch(&self, state: &mut ThreadState, pixels: impl Iterator<Item = u32> + Clone, first: u32, count: usize) {
        self.steps(state, pixels, first, count, &mut |_, _| {});
    }

    /// The same, with a look at the rays after each step.
    #[inline(always)]
    fn steps(
        &self,
        state: &mut ThreadState,
        pixels: impl Iterator<Item = u32> + Clone,
        first: u32,
        count: usize,
        look: &mut impl FnMut(Step, &RayBatch),
    ) {
        let isa = self.pipeline.isa;
        let mut len = 0;
        for pixel in pixels.clone() {
            for (dimension, column) in state.numbers.iter_mut().enumerate() {
                let out = &mut column.slice_mut(len + count)[len..];
                let (group, pixel, first) = (self.pipeline.group(dimension), u64::from(pixel), u64::from(first));
                self.numbers.fill_rotated(isa, pixel, first, group, dimension as u32, out);
            }
            len += count;
        }
        let start = |rays: &mut RayBatch| {
            for (from, pixel) in (0..).step_by(count).zip(pixels) {
                rays.columns_mut().tag[from..from + count].fill(pixel);
                rays.number(from, &self.numbers, ESTIMATOR, u64::from(pixel), u64::from(first));
            }
        };
        self.follow(state, len, start, look);
    }

    /// Traces `len` rays by the columns of numbers, from the pixels that `start` writes, with the numbers of their own that it gives.
    #[inline(always)]
    pub(crate) fn follow(
        &self,
        state: &mut ThreadState,
        len: usize,
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
        launch.place(&mut state.rays, u.slice(len), v.slice(len), isa);
        look(Step::Imager, &state.rays);
        let dark = self.rear.aim(&mut state.rays, a.slice(len), b.slice(len), isa);
        state.drop_dark(dark);
        look(Step::Pupil, &state.rays);
        launch.admit(&mut state.rays, isa);
        let ended = state.rays.len() - state.rays.alive();
        state.drop_dark(ended);
        look(Step::Imager, &state.rays);
        self.pipeline.tracer.trace(&mut state.rays, &mut state.work, Travel::Backward);
        look(Step::Lens, &state.rays);
        state.rays.set_stage(StageKey::SOURCE);
        self.radiance().radiance(&mut state.rays, isa);
        look(Step::Source, &state.rays);
        state.settle(isa);
    }

    /// Adds samples `first .. first + samples` of a tile's pixels to the sums.
    ///
    /// # Errors
    /// A contribution is no number, or does not fit; then nothing of the unit is added.
    fn unit(
        &self,
        state: &mut ThreadState,
        tile: &Tile,
        first: u32,
        samples: u32,
        sums: &ExactSums,
    ) -> Result<(), RenderError> {
        let channels = state.integers.len();
        let mut local = vec![0_i64; tile.len() as usize * channels];
        let capacity = state.rays.capacity() as u32;
        // As many whole pixels as the batch holds; where it holds not even one, parts of a pixel.
        let part = samples.min(capacity);
        let whole = (capacity / part).max(1);
        for begin in (0..tile.len()).step_by(whole as usize) {
            let pixels = (begin..tile.len().min(begin + whole)).map(|at| tile.pixel(at));
            let mut sample = first;
            while sample < first + samples {
                let count = part.min(first + samples - sample);
                self.batch(state, pixels.clone(), sample, count as usize);
                if !state.contributions(&self.pipeline, self.scale) {
                    let mut blame = Blame::default();
                    self.steps(state, pixels, sample, count as usize, &mut |step, rays| blame.look(step, rays));
                    return Err(blame.error(&self.pipeline, state, self.scale));
                }
                // The samples of a pixel lie together.
                let mut from = 0;
                for tags in state.rays.tags().chunk_by(|a, b| a == b) {
                    let (pixel, only) = pixel_and_channel(tags[0]);
                    let cell = tile.at(pixel) as usize * channels;
                    let rays = from..from + tags.len();
                    for (channel, integers) in state.integers.iter().enumerate() {
                        if only.is_none_or(|only| only as usize == self.pipeline.recorded[channel]) {
                            local[cell + channel] += integers[rays.clone()].iter().sum::<i64>();
                        }
                    }
                    from = rays.end;
                }
                sample += count;
            }
        }
        for (at, values) in (0..).zip(local.chunks_exact(channels)) {
            let cell = tile.pixel(at) as usize * channels;
            values.iter().enumerate().for_each(|(channel, value)| sums.add(cell + channel, *value));
        }
        Ok(())
    }
}

impl Backward {
    fn size(&self) -> FrameSize {
        self.pipeline.scene.imager.size()
    }

    /// Tile and samples of a unit.
    fn piece(samples: &Range<u64>, tiles: &[u32], unit: u64) -> (u32, Range<u64>) {
        let many = tiles.len() as u64;
        let first = samples.start + unit / many * u64::from(SAMPLES_PER_PASS);
        (tiles[(unit % many) as usize], first..samples.end.min(first + u64::from(SAMPLES_PER_PASS)))
    }

    fn tile(&self, tile: u32) -> Tile {
        let size = self.size();
        let across = size.width_px.div_ceil(TILE);
        let (column, row) = (tile % across * TILE, tile / across * TILE);
        let (columns, rows) = (TILE.min(size.width_px - column), TILE.min(size.height_px - row));
        Tile { width: size.width_px, column, row, columns, rows }
    }
}

/// A square of pixels; smaller at the frame's right and lower border.
struct Tile {
    /// Of the frame.
    width: u32,
    /// Of its first pixel.
    column: u32,
    row: u32,
    columns: u32,
    rows: u32,
}

impl Tile {
    fn len(&self) -> u32 {
        self.columns * self.rows
    }

    /// The pixel of the frame that is the tile's `at`.
    fn pixel(&self, at: u32) -> u32 {
        (self.row + at / self.columns) * self.width + self.column + at % self.columns
    }

    /// Which of the tile's a pixel of the frame is.
    fn at(&self, pixel: u32) -> u32 {
        (pixel / self.width - self.row) * self.columns + pixel % self.width - self.column
    }
}

impl Estimator for Backward {
    fn name(&self) -> &'static str {
        if self.pipeline.scattered { SCATTER } else { "backward" }
    }

    fn tiles(&self) -> usize {
        let size = self.size();
        size.width_px.div_ceil(TILE) as usize * size.height_px.div_ceil(TILE) as usize
    }

    fn tile_of(&self, pixel: usize) -> usize {
        let (width, side) = (self.size().width_px as usize, TILE as usize);
        pixel / width / side * width.div_ceil(side) + pixel % width / side
    }

    fn reseeded(&self, seed: u64) -> Box<dyn Estimator> {
        let numbers = self.pipeline.numbers(seed);
        Box::new(Self { pipeline: self.pipeline.clone(), rear: self.rear.clone(), numbers, scale: self.scale })
    }

    fn units(&self, samples: &Range<u64>, tiles: &[u32]) -> u64 {
        tiles.len() as u64 * (samples.end - samples.start).div_ceil(u64::from(SAMPLES_PER_PASS))
    }

    fn rays(&self, samples: &Range<u64>, tiles: &[u32]) -> u64 {
        let pixels = if tiles.len() == self.tiles() {
            self.size().pixels() as u64
        } else {
            tiles.iter().map(|tile| u64::from(self.tile(*tile).len())).sum()
        };
        pixels * (samples.end - samples.start)
    }

    fn scratch(&self) -> Scratch {
        Scratch(ThreadState::new(&self.pipeline, self.pipeline.scene.render.batch))
    }

    fn run(&self, samples: &Range<u64>, tiles: &[u32], unit: u64, scratch: &mut Scratch, sums: &ExactSums) -> Unit {
        let (tile, samples) = Self::piece(samples, tiles, unit);
        let tile = self.tile(tile);
        let count = (samples.end - samples.start) as u32;
        match self.unit(&mut scratch.0, &tile, samples.start as u32, count, sums) {
            Ok(()) => Unit { rays: u64::from(tile.len()) * u64::from(count), error: None },
            Err(error) => Unit { rays: 0, error: Some(error) },
        }
    }

    fn weights(&self, done: &Done, _rays: u64, time_s: f64) -> Vec<f64> {
        let tiles = self.tiles();
        let mut of_tile: Vec<u64> = (0..tiles as u32).map(|tile| done.samples_of(tile)).collect();
        if let Some((samples, units)) = done.open() {
            let active = done.active(tiles);
            for unit in units.ranges().flatten() {
                let (tile, piece) = Self::piece(samples, &active, unit);
                of_tile[tile as usize] += piece.end - piece.start;
            }
        }
        let weight = |pixel: usize| time_s / self.scale / of_tile[self.tile_of(pixel)].max(1) as f64;
        (0..self.size().pixels()).map(weight).collect()
    }

    fn metered(&self, workers: &dyn Workers) -> Result<Vec<Vec<f64>>, RenderError> {
        self.of_meters().map_or(Ok(Vec::new()), |meters| {
            let follow = |state: &mut ThreadState,
                          len,
                          start: &mut dyn FnMut(&mut RayBatch),
                          mut look: &mut dyn FnMut(Step, &RayBatch)| {
                meters.follow(state, len, start, &mut look);
            };
            meter::backward(&meters.pipeline, (ESTIMATOR, &follow), workers)
        })
    }
}

/// Points over the whole of an imager, those of its rim and corners among them: its shape, as the
/// search of the pupil needs it.
fn imager_rays(launch: &dyn Launch, size: FrameSize, isa: Isa) -> RayBatch {
    const SIDE: u32 = 65;
    let mut rays = RayBatch::new((SIDE * SIDE) as usize).with_numbers();
    rays.restart((SIDE * SIDE) as usize);
    // Pixel and place in it, from one edge of the frame to the other.
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
    launch.place(&mut rays, &u, &v, isa);
    rays
}

/// What was measured on some rays may be exceeded by others: this much room is left.
const ROOM: f64 = 1.25;

/// How far an imager moves rays aside after they were aimed, mm: the most of rays from all over it, in the middle and at four
/// sides of the pupil.
fn aside_mm(launch: &dyn Launch, rear: &RearPupil, points: &RayBatch, isa: Isa) -> f64 {
    let mut most = 0.0_f64;
    for (u, v) in [(0.5, 0.5), (0.02, 0.5), (0.98, 0.5), (0.5, 0.02), (0.5, 0.98)] {
        let mut rays = points.clone();
        let n = rays.len();
        rear.aim(&mut rays, &vec![u; n], &vec![v; n], isa);
        let before = rays.clone();
        rays.set_stage(StageKey::IMAGER);
        launch.admit(&mut rays, isa);
        let at = |rays: &RayBatch, i: usize| DVec3::from_array(rays.positions().map(|c| c[i]));
        for i in (0..n).filter(|i| before.loss(*i).is_none()) {
            let way = DVec3::from_array(rays.directions().map(|c| c[i]));
            let moved = at(&rays, i) - at(&before, i);
            most = most.max((moved - moved.dot(way) * way).length());
        }
    }
    most
}
