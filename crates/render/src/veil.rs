//! Estimates veiling glare: all light that reaches the imager other than directly, by random walks inside the lens
//! ([`spectra_tracer::Interior`]).
//!
//! **Lattice.** Glare is smooth and a walk is rare, so single pixels would show noise. It is estimated on a lattice of [`ACROSS`] cells
//! across the frame and interpolated linearly between the nodes. Each walk adds to the four nodes around it by hat functions, which
//! preserves the energy. What is lost is detail finer than a cell, of the order of the square of the cell size. A unit of work traces the
//! walks of some samples and then adds its lattice to the sums of all pixels. The sums of nodes are integers, and so are the weights of the
//! interpolation. The bits therefore do not depend on how samples are divided into units.
//!
//! **Walks** start at the source for bright lights, and at the imager for everything else. If ghosts are traced, light that glass reflected
//! twice belongs to them and is left out here.
//!
//! **Limits.** The estimator is on only if the scene asks for it. From a source such as the sun few walks find the film, and each of them
//! brings much light: 16 samples leave blotches of color all over the frame.

use crate::error::RenderError;
use crate::estimator::{Estimator, Scratch, UnitResult};
use crate::landing;
use crate::meter;
use crate::pilot::PILOT_SEED;
use crate::pipeline::{Pipeline, ThreadState};
use crate::sums::{ExactSums, scale_for};
use crate::{Done, Workers};
use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::batch::pixel_and_channel;
use spectra_core::loss::{ALIVE, Loss};
use spectra_core::numbers::{Numbers, StageKey, mix64};
use spectra_core::stage::{Emit, Radiance};
use spectra_core::workers::map_pieces;
use spectra_optics::FrontOpening;
use spectra_scene::{LightKind, Scene};
use spectra_tracer::{Interior, Particle, StrayReflectances, WalkNumbers, Walker};
use std::ops::Range;
use std::sync::Arc;

/// Estimator name from which the stages derive their own random numbers.
pub(crate) const ESTIMATOR: &str = "glare";
/// Turns the picture's seed into that of the walks.
const SEED: u64 = 0x0067_6c61_7265;
/// All walks draw from one stream of random numbers.
const STREAM: u64 = 0;
/// Number of lattice cells across the frame.
const ACROSS: usize = 16;
/// Number of walks in a sample, whatever the number of pixels, because the glare has as much detail at any resolution.
const WALKS_A_SAMPLE: u64 = 1 << 15;
/// Number of samples in a unit of work.
const SAMPLES_PER_UNIT: u64 = 8;
/// Number of pilot walks that measure how bright the glare is.
const PILOT_WALKS: u64 = 1 << 17;
/// Number of units of walks that measure what meters see.
const METER_UNITS: usize = 8;
/// Number of walks in each unit of a meter.
const METER_WALKS: u64 = 1 << 14;
/// Headroom of the sums: a node collects many walks and is multiplied by [`PARTS`] twice, so the scale is lower by this factor than for
/// single rays.
const HEADROOM: f64 = 64.0;
/// Number of interpolation steps from one node of the lattice to the next.
const PARTS: usize = 256;
/// Largest contribution of a walk to a node, scaled to integers.
const LARGEST: f64 = (1_u64 << 34) as f64;
/// Distance in front of the lens at which light starts, in radii of the front opening.
const BEFORE: f64 = 4.0;

/// The frame in the plane of the imager: its middle, half its width and half its height as vectors, mm.
#[derive(Clone, Copy)]
struct Frame {
    middle: [f64; 2],
    across: [f64; 2],
    down: [f64; 2],
}

impl Frame {
    fn of(pipeline: &Pipeline) -> Self {
        let [a, b, c, _] = <[[f64; 2]; 4]>::try_from(landing::corners(&pipeline.scene)).unwrap_or_default();
        // The corners are in this order: bottom right, top right, top left, bottom left of the picture.
        let half = |p: [f64; 2], q: [f64; 2]| [0.5 * (p[0] - q[0]), 0.5 * (p[1] - q[1])];
        let mut frame = Self { middle: half(a, c.map(|v| -v)), across: half(b, c), down: half(a, b) };
        if pipeline.scene.imager.launch().is_none() {
            // An imager that launches no rays has an upright frame: columns count opposite to x.
            frame.across = frame.across.map(|v| -v);
        }
        frame
    }

    /// Returns half the size of the frame along x and y, mm.
    fn half(&self) -> [f64; 2] {
        std::array::from_fn(|k| self.across[k].abs() + self.down[k].abs())
    }

    /// Returns the point (mm) at a position in the frame, 0 to 1 across and down.
    fn at(&self, u: f64, v: f64) -> [f64; 2] {
        std::array::from_fn(|k| self.middle[k] + self.across[k] * (2.0 * u - 1.0) + self.down[k] * (2.0 * v - 1.0))
    }

    /// Returns the position in the frame, 0 to 1 across and down, of a point (mm).
    fn place(&self, at: [f64; 2]) -> [f64; 2] {
        let from: [f64; 2] = std::array::from_fn(|k| at[k] - self.middle[k]);
        let [a, d] = [self.across, self.down];
        let det = a[0] * d[1] - a[1] * d[0];
        [(from[0] * d[1] - from[1] * d[0]) / det, (a[0] * from[1] - a[1] * from[0]) / det].map(|s| 0.5 * (s + 1.0))
    }

    fn area_mm2(&self) -> f64 {
        4.0 * (self.across[0] * self.down[1] - self.across[1] * self.down[0]).abs()
    }
}

/// The factor between the irradiance at a pixel and what the pixel records.
#[derive(Clone, Copy)]
struct PixelGain {
    gain: f32,
    /// The only channel of the pixel, plus one; 0 if it has all channels.
    only: u8,
}

/// The data that is prepared once per scene.
struct Plan {
    interior: Interior,
    frame: Frame,
    /// Opening at which the light of bright lights is aimed; `None` if walks start at the imager, or if the source directs its rays itself.
    opening: Option<FrontOpening>,
    /// Whether walks start at the source rather than at the imager.
    from_source: bool,
    /// Largest number of reflections by glass alone that another estimator traces; 0 for none.
    ghosts_order: u32,
    gains: Vec<PixelGain>,
    /// Number of lattice cells down the frame.
    rows: usize,
}

/// Estimator of veiling glare.
pub(crate) struct Veil {
    pipeline: Arc<Pipeline>,
    plan: Arc<Plan>,
    numbers: Numbers,
    seed: u64,
    scale: f64,
}

impl Veil {
    /// Prepares the glare of a share of the source, by walks from the source or from the imager. Paths of up to `ghosts_order` reflections
    /// belong to an estimator of ghosts; 0 if there is none.
    pub(crate) fn new(
        pipeline: Arc<Pipeline>,
        from_source: bool,
        ghosts_order: u32,
        matter: StrayReflectances,
    ) -> Result<Self, RenderError> {
        let scene = &pipeline.scene;
        if from_source {
            pipeline.source().emit().ok_or(RenderError::CannotEmit)?;
        } else {
            pipeline.source().radiance().ok_or(RenderError::NoRadiance)?;
        }
        let frame = Frame::of(&pipeline);
        let interior = interior(&pipeline, &frame, matter)?;
        let is_directed = pipeline.source().emit().is_some_and(Emit::is_directed);
        let opening = if from_source && !is_directed {
            Some(FrontOpening::of(&scene.lens).ok_or(RenderError::NoAperture)?)
        } else {
            None
        };
        let size = scene.imager.size();
        let rows = (ACROSS as f64 * size.height_mm / size.width_mm).round().clamp(1.0, 4.0 * ACROSS as f64) as usize;
        let gains = gains(&pipeline);
        let plan = Plan { interior, frame, opening, from_source, ghosts_order, gains, rows };
        let (numbers, seed) = (pipeline.numbers(PILOT_SEED ^ SEED), PILOT_SEED);
        let mut own = Self { pipeline, plan: Arc::new(plan), numbers, seed, scale: 1.0 };
        own.scale = own.pilot_scale()?;
        let seed = own.pipeline.seed;
        (own.numbers, own.seed) = (own.pipeline.numbers(mix64(seed ^ SEED)), seed);
        Ok(own)
    }

    fn channels(&self) -> usize {
        self.pipeline.responses.channels()
    }

    fn nodes(&self) -> usize {
        (ACROSS + 1) * (self.plan.rows + 1)
    }

    /// Finds the scale of the sums from the largest contribution to a node in a pilot.
    fn pilot_scale(&self) -> Result<f64, RenderError> {
        let mut state = ThreadState::new(&self.pipeline, self.pipeline.scene.render.batch);
        let (mut largest, mut is_number) = (0.0_f64, true);
        self.walk(&mut state, 0..PILOT_WALKS, &mut |_, value| {
            is_number &= value.is_finite();
            largest = largest.max(value.abs());
        });
        if !is_number {
            return Err(no_number());
        }
        Ok(scale_for(HEADROOM * largest))
    }

    /// Traces walks and calls `add` with what they bring to each node, channel by channel: irradiance, as if each node had all walks.
    fn walk(&self, state: &mut ThreadState, walks: Range<u64>, add: &mut impl FnMut(usize, f64)) {
        let isa = self.pipeline.isa;
        let plan = &*self.plan;
        let mut walker = Walker::new(&plan.interior);
        let capacity = state.rays.capacity() as u64;
        // Weight, wavelength and position in the frame of the light that reached the imager.
        let (mut weights, mut nm, mut places) = (Vec::new(), Vec::new(), Vec::new());
        let mut first = walks.start;
        while first < walks.end {
            let len = capacity.min(walks.end - first) as usize;
            for (dimension, column) in state.numbers.iter_mut().enumerate() {
                let group = self.pipeline.group(dimension);
                self.numbers.fill_rotated(isa, STREAM, first, group, dimension as u32, column.slice_mut(len));
            }
            state.draw_wavelengths(&self.pipeline, len);
            state.rays.number(0, &self.numbers, ESTIMATOR, STREAM, first);
            weights.clear();
            nm.clear();
            places.clear();
            if plan.from_source {
                self.start(state, len);
                let (at, way) = (state.rays.positions(), state.rays.directions());
                for i in (0..len).filter(|i| state.rays.states()[*i] == ALIVE && state.rays.weights()[*i] != 0.0) {
                    let wavelength = state.rays.wavelengths_nm()[i];
                    walker.set_wavelength(wavelength);
                    let start = Particle {
                        position: DVec3::from_array(at.map(|c| c[i])),
                        direction: DVec3::from_array(way.map(|c| c[i])),
                        weight: state.rays.weights()[i],
                        mirrored: 0,
                        scattered: 0,
                        diffused: 0,
                    };
                    walker.from_front(start, &mut WalkNumbers::new(self.seed ^ SEED, first + i as u64), |p| {
                        if self.is_ours(p) {
                            weights.push(p.weight / plan.frame.area_mm2());
                            nm.push(wavelength);
                            places.push(plan.frame.place([p.position.x, p.position.y]));
                        }
                    });
                }
            } else {
                let [_, u, v, _, _] = &state.numbers;
                let (u, v) = (u.slice(len), v.slice(len));
                let c = state.rays.columns_mut();
                for i in 0..len {
                    walker.set_wavelength(c.wavelength_nm[i]);
                    let mut chance = WalkNumbers::new(self.seed ^ SEED, first + i as u64);
                    let out = walker.from_imager(plan.frame.at(u[i], v[i]), &mut chance);
                    let Some(out) = out.filter(|out| self.is_ours(out)) else {
                        c.state[i] = Loss::Absorbed.state(0);
                        continue;
                    };
                    (c.x[i], c.y[i], c.z[i]) = out.position.into();
                    (c.l[i], c.m[i], c.n[i]) = out.direction.into();
                    c.weight[i] *= out.weight * std::f64::consts::PI;
                }
                state.rays.set_stage(StageKey::SOURCE);
                self.radiance().radiance(&mut state.rays);
                for i in (0..len).filter(|i| state.rays.states()[*i] == ALIVE && state.rays.weights()[*i] != 0.0) {
                    weights.push(state.rays.weights()[i]);
                    nm.push(state.rays.wavelengths_nm()[i]);
                    places.push([u[i], v[i]]);
                }
            }
            state.detected += weights.len() as u64;
            self.deposit(&weights, &nm, &places, add);
            first += len as u64;
        }
    }

    /// Whether light is stray and belongs to no other estimator.
    fn is_ours(&self, particle: &Particle) -> bool {
        let is_ghosts =
            particle.scattered == 0 && particle.diffused == 0 && particle.mirrored <= self.plan.ghosts_order;
        !(particle.is_straight() || is_ghosts)
    }

    fn radiance(&self) -> &dyn Radiance {
        self.pipeline.source().radiance().expect("checked by `new`")
    }

    /// Starts the light of bright lights in front of the lens, at the place where it is to enter.
    fn start(&self, state: &mut ThreadState, len: usize) {
        state.rays.set_stage(StageKey::SOURCE);
        let [_, u, v, a, b] = &state.numbers;
        let emit = self.pipeline.source().emit().expect("checked by `new`");
        emit.place(&mut state.rays, u.slice(len), v.slice(len));
        if let Some(opening) = &self.plan.opening {
            let (a, b) = (a.slice(len), b.slice(len));
            let c = state.rays.columns_mut();
            for i in 0..len {
                let point = DVec3::new(c.x[i], c.y[i], c.z[i]);
                let Some(disk) = opening.seen_from(point) else {
                    c.state[i] = Loss::Vignetted.state(1);
                    continue;
                };
                let (across, along) = spectra_core::math::concentric_disk(a[i], b[i]);
                let at = disk.center + disk.radial * along + disk.across * across;
                let distance = (at - point).length();
                let direction = (at - point) / distance;
                let start = at - direction * distance.min(BEFORE * opening.radius_mm());
                (c.x[i], c.y[i], c.z[i]) = start.into();
                (c.l[i], c.m[i], c.n[i]) = direction.into();
                let area = std::f64::consts::PI * disk.radial.length() * disk.across.length();
                c.weight[i] *= area * direction.dot(disk.sight) / (distance * distance);
            }
        }
        emit.radiate(&mut state.rays);
    }

    /// Adds each contribution to the four nodes around it: the hat function of the node there, divided by the mean of the hat over the
    /// frame.
    fn deposit(&self, weights: &[f64], nm: &[f64], places: &[[f64; 2]], add: &mut impl FnMut(usize, f64)) {
        let (columns, rows, nodes) = (ACROSS, self.plan.rows, self.nodes());
        let mut values = vec![0.0; weights.len()];
        for channel in 0..self.channels() {
            self.pipeline.isa.run(self.pipeline.responses.weigh(channel, nm, weights, &mut values));
            for (value, [u, v]) in values.iter().zip(places) {
                let cell = |at: f64, cells: usize| {
                    let at = at.clamp(0.0, 1.0) * cells as f64;
                    let first = (at as usize).min(cells - 1);
                    (first, at - first as f64)
                };
                let ((column, x), (row, y)) = (cell(*u, columns), cell(*v, rows));
                for (dr, wy) in [(0, 1.0 - y), (1, y)] {
                    for (dc, wx) in [(0, 1.0 - x), (1, x)] {
                        let (r, c) = (row + dr, column + dc);
                        // The mean of a hat over the frame is the share of one cell, and half of it at each edge.
                        let edge = |at: usize, last: usize| if at == 0 || at == last { 2.0 } else { 1.0 };
                        let over = (columns * rows) as f64 * edge(r, rows) * edge(c, columns);
                        add(channel * nodes + r * (columns + 1) + c, value * wx * wy * over);
                    }
                }
            }
        }
    }

    /// Adds a lattice to the sums of all pixels. The weights of nodes are integers, so the sum of two lattices is spread exactly like the
    /// two lattices one by one. However samples are cut into units, the bits are the same.
    fn spread(&self, lattice: &[i64], sums: &ExactSums) {
        let size = self.pipeline.scene.imager.size();
        let (width, height) = (size.width_px as usize, size.height_px as usize);
        let (channels, nodes, columns) = (self.channels(), self.nodes(), ACROSS);
        let cell = |pixel: usize, pixels: usize, cells: usize| {
            let at = (2 * pixel + 1) * cells * PARTS / (2 * pixels);
            (at / PARTS, (at % PARTS) as i64)
        };
        let across: Vec<(usize, i64)> = (0..width).map(|column| cell(column, width, columns)).collect();
        for row in 0..height {
            let (r, y) = cell(row, height, self.plan.rows);
            for channel in 0..channels {
                let node = |r: usize, c: usize| lattice[channel * nodes + r * (columns + 1) + c];
                // Interpolate this row of the picture at the columns of the lattice.
                let whole = PARTS as i64;
                let line: [i64; ACROSS + 1] = std::array::from_fn(|c| node(r, c) * (whole - y) + node(r + 1, c) * y);
                if line.iter().all(|value| *value == 0) {
                    continue;
                }
                let recorded = self.pipeline.recorded[channel] as u8 + 1;
                for (column, (c, x)) in across.iter().enumerate() {
                    let pixel = row * width + column;
                    let only = self.plan.gains[pixel].only;
                    if only == 0 || only == recorded {
                        sums.add(pixel * channels + channel, line[*c] * (whole - x) + line[c + 1] * x);
                    }
                }
            }
        }
    }

    /// Returns the value of one unit of the sums of this many walks, J/m2 in the given time, for a pixel with gain 1.
    fn worth(&self, walks: u64, time_s: f64) -> f64 {
        time_s / self.scale / walks.max(1) as f64 / (PARTS * PARTS) as f64
    }

    /// Measures the glare with few walks, W/m2 at each pixel, channel by channel.
    fn meter(mut self, workers: &dyn Workers) -> Result<Vec<Vec<f64>>, RenderError> {
        let (scene, many) = (Arc::clone(&self.pipeline.scene), self.channels() * self.nodes());
        let (pixels, channels) = (scene.imager.size().pixels(), self.channels());
        if scene.metered_pixels().is_empty() {
            return Ok(vec![vec![0.0; pixels]; channels]);
        }
        let walk = |state: &mut ThreadState, unit: usize| {
            if workers.should_stop() {
                return Err(RenderError::Stopped);
            }
            let (first, mut lattice) = (unit as u64 * METER_WALKS, vec![0.0; many]);
            self.walk(state, first..first + METER_WALKS, &mut |node, value| lattice[node] += value);
            Ok(lattice)
        };
        let fresh = || ThreadState::new(&self.pipeline, scene.render.batch);
        let units = map_pieces(workers, METER_UNITS, fresh, walk)?;
        let lattice: Vec<f64> = (0..many).map(|node| units.iter().map(|unit| unit[node]).sum()).collect();
        let largest = lattice.iter().fold(0.0_f64, |most, value| if value.abs() <= most { most } else { value.abs() });
        if !largest.is_finite() {
            return Err(no_number());
        }
        // All walks are done, so the largest node is known.
        self.scale = if largest > 0.0 { LARGEST / largest } else { 1.0 };
        let sums =
            ExactSums::new(pixels * channels).ok_or_else(|| RenderError::Memory(crate::memory_needed(&scene)))?;
        let lattice: Vec<i64> = lattice.iter().map(|value| (value * self.scale).round_ties_even() as i64).collect();
        self.spread(&lattice, &sums);
        let one = self.worth(METER_UNITS as u64 * METER_WALKS, 1.0);
        let weight = |pixel: usize| one * f64::from(self.plan.gains[pixel].gain);
        Ok(meter::planes(&sums, channels, weight, pixels))
    }

    /// Returns the samples of a unit.
    fn samples_of(samples: &Range<u64>, unit: u64) -> Range<u64> {
        let first = samples.start + unit * SAMPLES_PER_UNIT;
        first..samples.end.min(first + SAMPLES_PER_UNIT)
    }
}

impl Estimator for Veil {
    fn name(&self) -> &'static str {
        ESTIMATOR
    }

    fn light(&self) -> LightKind {
        LightKind::Glare
    }

    fn tiles(&self) -> usize {
        1
    }

    fn tile_of(&self, _pixel: usize) -> usize {
        0
    }

    fn reseeded(&self, picture: &Arc<Scene>, seed: u64) -> Box<dyn Estimator> {
        let numbers = self.pipeline.numbers(mix64(seed ^ SEED));
        let pipeline = Arc::new(self.pipeline.of_picture(picture));
        Box::new(Self { pipeline, plan: self.plan.clone(), numbers, seed, scale: self.scale })
    }

    fn units(&self, samples: &Range<u64>, tiles: &[u32]) -> u64 {
        if tiles.is_empty() { 0 } else { (samples.end - samples.start).div_ceil(SAMPLES_PER_UNIT) }
    }

    fn rays(&self, samples: &Range<u64>, tiles: &[u32]) -> u64 {
        if tiles.is_empty() { 0 } else { (samples.end - samples.start) * WALKS_A_SAMPLE }
    }

    fn scratch(&self) -> Scratch {
        Scratch(ThreadState::new(&self.pipeline, self.pipeline.scene.render.batch))
    }

    fn run(
        &self,
        samples: &Range<u64>,
        _tiles: &[u32],
        unit: u64,
        scratch: &mut Scratch,
        sums: &ExactSums,
    ) -> UnitResult {
        let samples = Self::samples_of(samples, unit);
        let walks = samples.start * WALKS_A_SAMPLE..samples.end * WALKS_A_SAMPLE;
        let rays = walks.end - walks.start;
        let mut lattice = vec![0_i64; self.channels() * self.nodes()];
        let mut largest = 0.0_f64;
        self.walk(&mut scratch.0, walks, &mut |node, value| {
            let value = value * self.scale;
            // NaN counts as larger than any number.
            largest = if value.abs() <= largest { largest } else { value.abs() };
            lattice[node] += value.round_ties_even() as i64;
        });
        if !(largest < LARGEST) {
            return UnitResult { rays: 0, error: Some(RenderError::Overflow { times: largest / LARGEST }) };
        }
        self.spread(&lattice, sums);
        UnitResult { rays, error: None }
    }

    fn weights(&self, _done: &[&Done], rays: u64, time_s: f64) -> Vec<f64> {
        let one = self.worth(rays, time_s);
        self.plan.gains.iter().map(|pixel| one * f64::from(pixel.gain)).collect()
    }

    fn metered(&self, workers: &dyn Workers) -> Result<Vec<Vec<f64>>, RenderError> {
        let Some(pipeline) = self.pipeline.of_meters() else { return Ok(Vec::new()) };
        let seed = pipeline.seed ^ meter::SEED;
        let numbers = pipeline.numbers(mix64(seed ^ SEED));
        Self { pipeline: Arc::new(pipeline), plan: Arc::clone(&self.plan), numbers, seed, scale: 1.0 }.meter(workers)
    }
}

fn no_number() -> RenderError {
    RenderError::Glare("the source gives light that is not a finite number".to_owned())
}

/// Checks whether the veiling glare that a scene asks for can be computed.
pub(crate) fn check(pipeline: &Pipeline) -> Result<(), RenderError> {
    let Some(matter) = pipeline.scene.render.glare else { return Ok(()) };
    interior(pipeline, &Frame::of(pipeline), matter).map(|_| ())
}

/// Builds the interior of the lens and the camera.
fn interior(pipeline: &Pipeline, frame: &Frame, matter: StrayReflectances) -> Result<Interior, RenderError> {
    let scene = &pipeline.scene;
    let band_nm = [scene.grid.start_nm, scene.grid.end_nm()];
    let interior = Interior::new(&scene.lens, frame.half().map(|h| 2.0 * h), band_nm, matter);
    Ok(interior.map_err(|e| RenderError::Glare(e.to_string()))?.with_imager_at(frame.middle))
}

/// Returns the channel of each pixel of a mosaic; `None` if the pixels of the imager have all channels.
pub(crate) fn filters(pipeline: &Pipeline) -> Option<Vec<u8>> {
    let gains = gains(pipeline);
    gains.iter().any(|gain| gain.only != 0).then(|| gains.iter().map(|gain| gain.only.saturating_sub(1)).collect())
}

/// Computes what each pixel records of light along the normal, at the middle of the band.
fn gains(pipeline: &Pipeline) -> Vec<PixelGain> {
    const BATCH: usize = 4096;
    let scene = &pipeline.scene;
    let pixels = scene.imager.size().pixels();
    let Some(launch) = scene.imager.launch() else { return vec![PixelGain { gain: 1.0, only: 0 }; pixels] };
    let numbers = pipeline.numbers(PILOT_SEED);
    let mut all = Vec::with_capacity(pixels);
    let mut rays = RayBatch::new(BATCH);
    if launch.draws() {
        rays = rays.with_numbers();
    }
    let half = [0.5; BATCH];
    for first in (0..pixels).step_by(BATCH) {
        let len = BATCH.min(pixels - first);
        rays.restart(len);
        let c = rays.columns_mut();
        for i in 0..len {
            (c.tag[i], c.weight[i]) = ((first + i) as u32, 1.0);
            c.wavelength_nm[i] = 0.5 * (scene.grid.start_nm + scene.grid.end_nm());
        }
        rays.number(0, &numbers, ESTIMATOR, STREAM, first as u64);
        rays.set_stage(StageKey::IMAGER);
        launch.place(&mut rays, &half[..len], &half[..len]);
        launch.admit(&mut rays);
        all.extend((0..len).map(|i| {
            let is_alive = rays.states()[i] == ALIVE;
            let only = pixel_and_channel(rays.tags()[i]).1.map_or(0, |only| only as u8 + 1);
            PixelGain { gain: if is_alive { rays.weights()[i] as f32 } else { 0.0 }, only }
        }));
    }
    all
}
