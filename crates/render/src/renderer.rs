//! The renderer: units of work, handed to threads, summed exactly.

use crate::backward::{Backward, PIXELS_PER_UNIT, SAMPLES_PER_PASS};
use crate::blame::{Blame, Step};
use crate::forward::{Forward, PATHS_PER_UNIT};
use crate::landing::Landing;
use crate::memory::memory_needed;
use crate::meter;
use crate::pipeline::{Pipeline, ThreadState};
use crate::remarks::remarks;
use crate::sums::{ExactSums, LARGEST_CONTRIBUTION, LARGEST_EXPECTED, scale_for};
use crate::{Control, RenderError};
use spectra_core::frame::{ExposureChannel, ExposureFrame};
use spectra_core::{Isa, LossCounts, RayBatch};
use spectra_lens::Travel;
use spectra_scene::{Direction, Scene};
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// What a render gives.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// Linear exposure per channel.
    pub exposure: ExposureFrame,
    /// Rays launched toward the first or last surface.
    pub rays: u64,
    /// What was lost, by cause and surface.
    pub losses: LossCounts,
    /// Rays that brought light to the imager: with those that were lost, all that were launched.
    pub detected: u64,
    /// Whether it was stopped before its end.
    pub partial: bool,
    /// What a person should know before believing the picture, and what to write.
    pub warnings: Vec<String>,
}

pub(crate) enum Way<'a> {
    Forward(Forward<'a>),
    Backward(Backward<'a>),
}

/// A scene made ready to render.
pub struct Renderer<'a> {
    scene: &'a Scene,
    way: Way<'a>,
    scale: f64,
    meter: Option<Meter<'a>>,
}

/// What the camera's meters see: the same way of the light, other channels.
struct Meter<'a> {
    way: Way<'a>,
    scale: f64,
}

/// Seed of the pilot: the scale of the sums must not depend on the seed of the render, so that
/// renders of the same scene with other seeds add.
const PILOT_SEED: u64 = 0x5ca1e;
/// Rays of a pilot batch.
pub(crate) const PILOT_RAYS: u32 = 4096;
/// Batches tried before a scene is taken to be dark.
const PILOT_BATCHES: u32 = 64;

impl<'a> Renderer<'a> {
    /// Makes a scene ready: fits the wavelength density, searches pupils, finds the scale of the sums.
    ///
    /// # Errors
    /// [`RenderError`]: a stage lacks the ability that the direction needs, or the source's files are broken.
    pub fn new(scene: &'a Scene, isa: Isa) -> Result<Self, RenderError> {
        scene.source.prepare().map_err(RenderError::Source)?;
        let pilot = Self::way(scene, isa, PILOT_SEED)?;
        let scale = Self::scale(scene, &pilot)?;
        let meter = if scene.meter_channels().is_empty() { None } else { pilot.of_meters() };
        let meter =
            meter.map(|way| Ok(Meter { scale: Self::scale(scene, &way)?, way: way.reseeded(seed_of_meter(scene)) }));
        Ok(Self { scene, way: pilot.reseeded(scene.render.seed), scale, meter: meter.transpose()? })
    }

    /// Looks whether a scene can be made ready: what [`Renderer::new`] refuses, as far as that shows without
    /// its search for pupils, its pilot and the large files of a source.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn check(scene: &Scene, isa: Isa) -> Result<(), RenderError> {
        Pipeline::new(scene, isa)?;
        let sized = |travel| spectra_lens::has_sizes(&scene.lens, travel);
        let is_open = match scene.render.direction {
            Direction::Forward => {
                let emit = scene.source.emit().ok_or(RenderError::CannotEmit)?;
                scene.imager.receive().ok_or(RenderError::CannotReceive)?;
                emit.is_directed() || sized(Travel::Forward)
            }
            Direction::Backward => {
                scene.imager.launch().ok_or(RenderError::CannotLaunch)?;
                scene.source.radiance().ok_or(RenderError::NoRadiance)?;
                sized(Travel::Backward)
            }
        };
        if is_open { Ok(()) } else { Err(RenderError::NoAperture) }
    }

    fn way(scene: &'a Scene, isa: Isa, seed: u64) -> Result<Way<'a>, RenderError> {
        let pipeline = Pipeline::new(scene, isa)?;
        Ok(match scene.render.direction {
            Direction::Forward => Way::Forward(Forward::new(pipeline, seed)?),
            Direction::Backward => Way::Backward(Backward::new(pipeline, seed)?),
        })
    }

    /// The scale of the sums.
    fn scale(scene: &Scene, way: &Way<'_>) -> Result<f64, RenderError> {
        Ok(scale_for(Self::pilot(scene, way)? * scene.source.peak_over_mean().max(1.0)))
    }

    /// The largest contribution among some thousand rays.
    fn pilot(scene: &Scene, way: &Way<'_>) -> Result<f64, RenderError> {
        let mut state = ThreadState::new(way.pipeline(), PILOT_RAYS as usize);
        for batch in 0..PILOT_BATCHES {
            let mut blame = Blame::default();
            let look = &mut |step: Step, rays: &RayBatch| blame.look(step, rays);
            match way {
                Way::Forward(forward) => {
                    forward.steps(&mut state, u64::from(batch * PILOT_RAYS), PILOT_RAYS as usize, look);
                }
                Way::Backward(backward) => {
                    let pixels = scene.imager.size().pixels() as u64;
                    let spread = (0..PILOT_RAYS).map(|i| (u64::from(i) * pixels / u64::from(PILOT_RAYS)) as u32);
                    backward.steps(&mut state, spread, batch, 1, look);
                }
            }
            // A stage that is broken shows before any light is traced, if a few thousand rays find it.
            if let Some(error) = blame.no_number(way.pipeline()) {
                return Err(error);
            }
            let largest = state.largest(way.pipeline());
            if largest > 0.0 {
                return Ok(largest);
            }
        }
        Ok(0.0)
    }

    /// Where the light of the source lands in the plane of the imager, whichever way the scene is rendered; `None` where
    /// the source cannot emit, or nothing passes the lens.
    #[must_use]
    pub fn landing(&self) -> Option<Landing> {
        let pipeline = Pipeline::new(self.scene, self.way.pipeline().isa).ok()?;
        let forward = Forward::new(pipeline, PILOT_SEED).ok()?;
        let mut state = ThreadState::new(&forward.pipeline, PILOT_RAYS as usize);
        let mut landing = None;
        forward.steps(&mut state, 0, PILOT_RAYS as usize, &mut |step, rays| {
            if step == Step::Lens {
                landing = Landing::of(self.scene, rays, forward.pipeline.isa);
            }
        });
        landing
    }

    /// Renders on `threads` threads until the end, or until `control` says stop.
    ///
    /// # Errors
    /// [`RenderError::Memory`], [`RenderError::Threads`]; and as soon as a ray shows it, [`RenderError::NoNumber`] or
    /// [`RenderError::Overflow`].
    pub fn run(&self, threads: usize, control: &Control) -> Result<Rendering, RenderError> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.max(1))
            .build()
            .map_err(|e| RenderError::Threads(e.to_string()))?;
        let size = self.scene.imager.size();
        let recorded = &self.way.pipeline().recorded;
        let channels = recorded.len();
        let too_large = || RenderError::Memory(memory_needed(self.scene));
        let sums = ExactSums::new(size.pixels() * channels).ok_or_else(too_large)?;
        let failure: Mutex<Option<RenderError>> = Mutex::new(None);
        let failed = AtomicBool::new(false);
        let fail = |error: RenderError| {
            failed.store(true, Relaxed);
            failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        };
        let plan = Plan::new(&self.way, self.scene);
        control.expect(plan.rays);
        let metered = match &self.meter {
            Some(Meter { way: Way::Backward(way), .. }) => meter::backward(way, &pool)?,
            Some(Meter { way: Way::Forward(way), scale }) => meter::forward(way, *scale, &pool)?,
            None => Vec::new(),
        };
        let next = AtomicU64::new(0);
        let paths_done = AtomicU64::new(0);
        let samples_done: Vec<AtomicU32> = (0..plan.tiles).map(|_| AtomicU32::new(0)).collect();
        let losses = pool.broadcast(|_| {
            let mut state = ThreadState::new(self.way.pipeline(), self.scene.render.batch);
            while !control.should_stop() && !failed.load(Relaxed) {
                let unit = next.fetch_add(1, Relaxed);
                if unit >= plan.units {
                    break;
                }
                let rays = match &self.way {
                    Way::Forward(forward) => {
                        let first = unit * PATHS_PER_UNIT;
                        let paths = PATHS_PER_UNIT.min(plan.rays - first);
                        let (done, error) = forward.unit(&mut state, first, paths, self.scale, &sums);
                        paths_done.fetch_add(done, Relaxed);
                        error.into_iter().for_each(fail);
                        done
                    }
                    Way::Backward(backward) => {
                        let (tile, pass) = ((unit % plan.tiles) as u32, (unit / plan.tiles) as u32);
                        let begin = tile * PIXELS_PER_UNIT;
                        let end = (begin + PIXELS_PER_UNIT).min(size.pixels() as u32);
                        let first = pass * SAMPLES_PER_PASS;
                        let samples = SAMPLES_PER_PASS.min(self.scene.render.samples - first);
                        match backward.unit(&mut state, begin, end, first, samples, self.scale, &sums) {
                            Ok(()) => {
                                samples_done[tile as usize].fetch_add(samples, Relaxed);
                                u64::from(end - begin) * u64::from(samples)
                            }
                            Err(error) => {
                                fail(error);
                                0
                            }
                        }
                    }
                };
                control.launched(rays);
                if sums.overflowed() {
                    // A pixel's sum: so many contributions that none of them is to blame.
                    fail(RenderError::Overflow { times: LARGEST_CONTRIBUTION / LARGEST_EXPECTED, so_far: None });
                }
            }
            (state.work.losses, state.detected)
        });
        let failure = failure.into_inner().unwrap_or_else(PoisonError::into_inner);
        if let Some(error @ RenderError::NoNumber(_)) = failure {
            return Err(error);
        }
        let (mut all, mut detected) = (LossCounts::default(), 0);
        for (losses, lit) in &losses {
            all.merge(losses);
            detected += lit;
        }
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
        let of_meter = self.meter.as_ref().map_or(&[][..], |meter| &meter.way.pipeline().recorded);
        let time_s = self.scene.exposure_time_s();
        let mut planes = Vec::with_capacity(self.scene.channels.len());
        for (number, channel) in self.scene.channels.iter().enumerate() {
            let mut values = Vec::new();
            values.try_reserve_exact(size.pixels()).map_err(|_| too_large())?;
            if let Some(at) = recorded.iter().position(|r| *r == number) {
                values.extend((0..size.pixels()).map(|p| (sums.get(p * channels + at) as f64 * weight(p)) as f32));
            } else if let Some(at) = of_meter.iter().position(|r| *r == number) {
                values.extend(metered[at].iter().map(|value| (value * time_s) as f32));
            } else {
                // A meter that sees nothing of this source.
                values.resize(size.pixels(), 0.0);
            }
            planes.push(ExposureChannel { name: channel.name.clone(), unit: channel.unit.clone(), values });
        }
        drop(sums);
        let mut rendering = Rendering {
            exposure: ExposureFrame { size, channels: planes },
            rays: control.rays(),
            losses: all,
            detected,
            partial: control.rays() < plan.rays,
            warnings: Vec::new(),
        };
        rendering.warnings = remarks(self, &rendering);
        match failure {
            Some(RenderError::Overflow { times, .. }) => {
                rendering.partial = true;
                Err(RenderError::Overflow { times, so_far: Some(Box::new(rendering)) })
            }
            Some(error) => Err(error),
            None => Ok(rendering),
        }
    }

    /// The scene.
    pub(crate) fn scene(&self) -> &'a Scene {
        self.scene
    }
}

/// Seed of the meter's numbers: not the picture's.
fn seed_of_meter(scene: &Scene) -> u64 {
    scene.render.seed ^ meter::SEED
}

impl<'a> Way<'a> {
    /// The same for what the meters see; `None` where they see nothing.
    fn of_meters(&self) -> Option<Self> {
        Some(match self {
            Self::Forward(forward) => Self::Forward(forward.through(forward.pipeline.of_meters()?)),
            Self::Backward(backward) => Self::Backward(backward.through(backward.pipeline.of_meters()?)),
        })
    }

    /// The same with the numbers of another seed.
    fn reseeded(self, seed: u64) -> Self {
        match self {
            Way::Forward(forward) => Way::Forward(forward.reseeded(seed)),
            Way::Backward(backward) => Way::Backward(backward.reseeded(seed)),
        }
    }

    fn pipeline(&self) -> &Pipeline<'a> {
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
