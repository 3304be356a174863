//! The renderer: units of work, handed to threads, summed exactly.

use crate::backward::{Backward, PIXELS_PER_UNIT, SAMPLES_PER_PASS};
use crate::forward::{Forward, PATHS_PER_UNIT};
use crate::pipeline::{Pipeline, ThreadState};
use crate::sums::{ExactSums, scale_for};
use crate::{Control, RenderError};
use spectra_core::frame::{ExposureChannel, ExposureFrame};
use spectra_core::{Isa, LossCounts};
use spectra_scene::{Direction, Scene};
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

/// What a render gives.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// Linear exposure per channel.
    pub exposure: ExposureFrame,
    /// Rays launched toward the first or last surface.
    pub rays: u64,
    /// What was lost, by cause and surface.
    pub losses: LossCounts,
    /// Whether it was stopped before its end.
    pub partial: bool,
}

enum Way<'a> {
    Forward(Forward<'a>),
    Backward(Backward<'a>),
}

/// A scene made ready to render.
pub struct Renderer<'a> {
    scene: &'a Scene,
    way: Way<'a>,
    scale: f64,
}

/// Seed of the pilot: the scale of the sums must not depend on the seed of the render, so that
/// renders of the same scene with other seeds add.
const PILOT_SEED: u64 = 0x5ca1e;
/// Rays of a pilot batch.
const PILOT_RAYS: u32 = 4096;
/// Batches tried before a scene is taken to be dark.
const PILOT_BATCHES: u32 = 64;

impl<'a> Renderer<'a> {
    /// Makes a scene ready: fits the wavelength density, searches pupils, finds the scale of the sums.
    ///
    /// # Errors
    /// [`RenderError`]: a stage lacks the ability that the direction needs, or the source's files are broken.
    pub fn new(scene: &'a Scene, isa: Isa) -> Result<Self, RenderError> {
        scene.source.prepare().map_err(RenderError::Source)?;
        Self::put_together(scene, isa)
    }

    /// Whether a scene can be made ready, as far as that can be told without reading large files of its source.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn check(scene: &'a Scene, isa: Isa) -> Result<(), RenderError> {
        Self::put_together(scene, isa).map(drop)
    }

    fn put_together(scene: &'a Scene, isa: Isa) -> Result<Self, RenderError> {
        let pilot = Self::way(scene, isa, PILOT_SEED)?;
        let largest = Self::pilot(scene, &pilot);
        let scale = scale_for(largest * scene.source.peak_over_mean().max(1.0));
        Ok(Self { scene, way: pilot.reseeded(scene.render.seed), scale })
    }

    fn way(scene: &'a Scene, isa: Isa, seed: u64) -> Result<Way<'a>, RenderError> {
        let pipeline = Pipeline::new(scene, isa)?;
        Ok(match scene.render.direction {
            Direction::Forward => Way::Forward(Forward::new(pipeline, seed)?),
            Direction::Backward => Way::Backward(Backward::new(pipeline, seed)?),
        })
    }

    /// The largest contribution among some thousand rays.
    fn pilot(scene: &Scene, way: &Way<'_>) -> f64 {
        let mut state = ThreadState::new(way.pipeline(), PILOT_RAYS as usize);
        for batch in 0..PILOT_BATCHES {
            match way {
                Way::Forward(forward) => forward.batch(&mut state, u64::from(batch * PILOT_RAYS), PILOT_RAYS as usize),
                Way::Backward(backward) => {
                    let pixels = scene.imager.size().pixels() as u64;
                    let spread = (0..PILOT_RAYS).map(|i| (u64::from(i) * pixels / u64::from(PILOT_RAYS)) as u32);
                    backward.batch(&mut state, spread, batch, 1);
                }
            }
            let largest = state.largest(way.pipeline());
            if largest > 0.0 {
                return largest;
            }
        }
        0.0
    }

    /// Renders on `threads` threads until the end, or until `control` says stop.
    ///
    /// # Errors
    /// [`RenderError::Overflow`], [`RenderError::Threads`].
    pub fn run(&self, threads: usize, control: &Control) -> Result<Rendering, RenderError> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.max(1))
            .build()
            .map_err(|e| RenderError::Threads(e.to_string()))?;
        let size = self.scene.imager.size();
        let channels = self.scene.channels.len();
        let sums = ExactSums::new(size.pixels() * channels);
        let plan = Plan::new(&self.way, self.scene);
        control.expect(plan.rays);
        let next = AtomicU64::new(0);
        let paths_done = AtomicU64::new(0);
        let samples_done: Vec<AtomicU32> = (0..plan.tiles).map(|_| AtomicU32::new(0)).collect();
        let losses = pool.broadcast(|_| {
            let mut state = ThreadState::new(self.way.pipeline(), self.scene.render.batch);
            while !control.should_stop() {
                let unit = next.fetch_add(1, Relaxed);
                if unit >= plan.units {
                    break;
                }
                let rays = match &self.way {
                    Way::Forward(forward) => {
                        let first = unit * PATHS_PER_UNIT;
                        let paths = PATHS_PER_UNIT.min(plan.rays - first);
                        forward.unit(&mut state, first, paths, self.scale, &sums);
                        paths_done.fetch_add(paths, Relaxed);
                        paths
                    }
                    Way::Backward(backward) => {
                        let (tile, pass) = ((unit % plan.tiles) as u32, (unit / plan.tiles) as u32);
                        let begin = tile * PIXELS_PER_UNIT;
                        let end = (begin + PIXELS_PER_UNIT).min(size.pixels() as u32);
                        let first = pass * SAMPLES_PER_PASS;
                        let samples = SAMPLES_PER_PASS.min(self.scene.render.samples - first);
                        backward.unit(&mut state, begin, end, first, samples, self.scale, &sums);
                        samples_done[tile as usize].fetch_add(samples, Relaxed);
                        u64::from(end - begin) * u64::from(samples)
                    }
                };
                control.launched(rays);
            }
            state.work.losses
        });
        if sums.overflowed() {
            return Err(RenderError::Overflow);
        }
        let mut all = LossCounts::default();
        losses.iter().for_each(|l| all.merge(l));
        // What one unit of the sums is worth: exposure over the number of samples.
        let paths = paths_done.load(Relaxed);
        let forward_weight = self.scene.exposure_time_s() / self.scale / size.pixel_area_mm2() / (paths.max(1) as f64);
        let backward_weight = self.scene.exposure_time_s() / self.scale;
        let weight = |pixel: usize| match &self.way {
            Way::Forward(_) => forward_weight,
            Way::Backward(_) => {
                let done = samples_done[pixel / PIXELS_PER_UNIT as usize].load(Relaxed);
                backward_weight / f64::from(done.max(1))
            }
        };
        let planes = self.scene.channels.iter().enumerate().map(|(at, channel)| ExposureChannel {
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            values: (0..size.pixels()).map(|p| (sums.get(p * channels + at) as f64 * weight(p)) as f32).collect(),
        });
        Ok(Rendering {
            exposure: ExposureFrame { size, channels: planes.collect() },
            rays: control.rays(),
            losses: all,
            partial: control.rays() < plan.rays,
        })
    }
}

impl Way<'_> {
    /// The same with the numbers of another seed.
    fn reseeded(self, seed: u64) -> Self {
        match self {
            Way::Forward(forward) => Way::Forward(forward.reseeded(seed)),
            Way::Backward(backward) => Way::Backward(backward.reseeded(seed)),
        }
    }

    fn pipeline(&self) -> &Pipeline<'_> {
        match self {
            Way::Forward(forward) => &forward.pipeline,
            Way::Backward(backward) => &backward.pipeline,
        }
    }
}

/// How the work is cut.
struct Plan {
    units: u64,
    tiles: u64,
    rays: u64,
}

impl Plan {
    fn new(way: &Way<'_>, scene: &Scene) -> Self {
        match way {
            Way::Forward(_) => {
                let rays = scene.render.rays;
                Self { units: rays.div_ceil(PATHS_PER_UNIT), tiles: 0, rays }
            }
            Way::Backward(_) => {
                let pixels = scene.imager.size().pixels() as u64;
                let tiles = pixels.div_ceil(u64::from(PIXELS_PER_UNIT));
                let passes = u64::from(scene.render.samples.div_ceil(SAMPLES_PER_PASS));
                Self { units: tiles * passes, tiles, rays: pixels * u64::from(scene.render.samples) }
            }
        }
    }
}
