//! The renderer: hands units of work to threads and sums their light exactly.

use crate::done::{Done, Units};
use crate::estimator::Estimator;
use crate::estimators::Estimators;
use crate::forward::Forward;
use crate::ghosts::LightLedger;
use crate::landing::Landing;
use crate::light::{EstimatorSums, Light};
use crate::memory::memory_needed;
use crate::noise::{ends_round, next_round};
use crate::parts::{Part, Parts, Role};
use crate::passes::{first_units, next_pass};
use crate::pipeline::{Pipeline, ThreadState};
use crate::rendering::{GhostNoise, Rendering};
use crate::sums::{ExactSums, LARGEST_CONTRIBUTION, LARGEST_EXPECTED, PILOT_RAYS};
use crate::veil::{self};
use crate::{Control, RenderError, RenderOptions, SingleThread, Traced, Workers, diffracted, star_trial};
use spectra_core::LossCounts;
use spectra_core::frame::{ExposureChannel, ExposureFrame};
use spectra_core::stage::WavelengthDensity;
use spectra_optics::Effort;
use spectra_scene::{Direction, LightKind, NumberFamily, Scene};
use spectra_tracer::Travel;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// A thread takes one part in this many of all units at a time, so that no thread waits long for the others.
const UNITS_A_RUN: u64 = 1024;
/// Largest number of units that a thread takes at a time.
const LONGEST_RUN: u64 = 16;

/// A scene that is ready to render.
pub struct Renderer {
    scene: Arc<Scene>,
    pipeline: Arc<Pipeline>,
    parts: Parts,
    ledger: Option<LightLedger>,
    /// Whether the bright lights of the source are rendered separately: the first estimator is of the rest, the second of the lights.
    has_lights: bool,
    /// Whether the star of a lamp is bright enough to be seen, once it is known.
    is_star_seen: OnceLock<bool>,
    /// Whether a file of the light itself is asked for.
    keeps_light: bool,
    /// Medians of the frame, once they are known: see [`Renderer::medians`].
    known_medians: OnceLock<Vec<f64>>,
}

impl Renderer {
    /// Prepares a scene: fits the wavelength density, searches the pupils and finds the scale of the sums.
    ///
    /// # Errors
    /// Returns a [`RenderError`] if a stage lacks an ability that the direction needs, if files of the source are broken, or if the workers
    /// are to stop meanwhile.
    pub fn new(scene: impl Into<Arc<Scene>>, options: &RenderOptions<'_>) -> Result<Self, RenderError> {
        Self::prepared(scene.into(), options, None)
    }

    /// Prepares another picture like [`Renderer::new`], with the same bits. What this renderer has found is taken over where it does not
    /// depend on what differs between the pictures: everything if only their seeds and what follows the light differ, and the pupil that the
    /// imager sees if their lens, imager and band are the same.
    ///
    /// # Errors
    /// Returns the same errors as [`Renderer::new`].
    pub fn for_picture(
        &self,
        picture: impl Into<Arc<Scene>>,
        options: &RenderOptions<'_>,
    ) -> Result<Self, RenderError> {
        let picture = picture.into();
        let is_same = options.isa == self.pipeline.isa
            && options.effort == self.pipeline.effort
            && options.traced == Traced::All
            && self.scene.differs_in_seed_only(&picture);
        if is_same {
            let keeps_light = options.keeps_light || picture.names_light_output();
            return Ok(Self { keeps_light, ..self.of_picture(picture) });
        }
        Self::prepared(picture, options, Some(&self.pipeline))
    }

    fn prepared(
        scene: Arc<Scene>,
        options: &RenderOptions<'_>,
        earlier: Option<&Pipeline>,
    ) -> Result<Self, RenderError> {
        scene.source.prepare().map_err(RenderError::Source)?;
        let mut pipeline = Pipeline::new(&scene, options)?;
        if let Some(earlier) = earlier {
            pipeline.take_pupil(earlier);
        }
        let pipeline = Arc::new(pipeline);
        let Estimators { all, ledger, has_lights } = Estimators::new(&pipeline, &options.traced, options.workers)?;
        let parts = Parts::new(&scene, all);
        let (is_star_seen, known_medians) = (OnceLock::new(), OnceLock::new());
        let keeps_light = options.keeps_light || scene.names_light_output();
        let own = Self { parts, scene, pipeline, ledger, has_lights, is_star_seen, keeps_light, known_medians };
        // Decided before light is traced, so that a render that is stopped knows it. A draft shows no stars.
        if own.scene.render.diffraction.is_none() && options.effort == Effort::Full {
            own.is_star_seen()?;
        }
        Ok(own)
    }

    /// Ledger of the light of the bright lights, if ghosts are traced.
    #[must_use]
    pub fn ledger(&self) -> Option<&LightLedger> {
        self.ledger.as_ref()
    }

    /// Returns a copy for the picture of another seed, with the same bits as [`Renderer::new`] for the scene with that seed. What was
    /// searched and decided before the first ray does not depend on the seed and is shared, so this costs next to nothing.
    #[must_use]
    pub fn reseeded(&self, seed: u64) -> Self {
        self.of_picture(Arc::new(self.scene.with_seed(seed)))
    }

    fn of_picture(&self, picture: Arc<Scene>) -> Self {
        Self {
            parts: self.parts.of_picture(&picture),
            pipeline: Arc::new(self.pipeline.of_picture(&picture)),
            scene: picture,
            ledger: self.ledger.clone(),
            has_lights: self.has_lights,
            is_star_seen: self.is_star_seen.clone(),
            keeps_light: self.keeps_light,
            known_medians: self.known_medians.clone(),
        }
    }

    /// Checks whether a scene can be prepared: reports what [`Renderer::new`] refuses, as far as that shows without its search for pupils,
    /// its pilot and the large files of a source.
    ///
    /// # Errors
    /// Returns the same errors as [`Renderer::new`].
    pub fn check(scene: &Arc<Scene>) -> Result<(), RenderError> {
        let pipeline = Pipeline::new(scene, &RenderOptions::default())?;
        veil::check(&pipeline)?;
        let sized = |travel| spectra_optics::has_sizes(&scene.lens, travel);
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

    /// Finds where the light of the source lands in the plane of the imager, whichever way the scene is rendered. `None` if the source
    /// cannot emit, or if nothing passes the lens.
    #[must_use]
    pub fn landing(&self) -> Option<Landing> {
        let forward = Forward::aimed(Arc::clone(&self.pipeline), &SingleThread).ok()?;
        let mut state = ThreadState::new(&self.pipeline, PILOT_RAYS as usize);
        let mut landing = None;
        forward.steps(&mut state, 0, PILOT_RAYS as usize, &mut |step, rays| {
            if step == crate::Step::Lens {
                landing = Landing::of(&self.scene, rays);
            }
        });
        landing
    }

    /// Renders all samples that the scene states, or until `control` asks to stop.
    ///
    /// # Errors
    /// Returns the same errors as [`Renderer::advance`].
    pub fn run(&self, workers: &dyn Workers, control: &Control) -> Result<Rendering, RenderError> {
        let mut light = self.begin()?;
        self.advance(&mut light, u64::from(self.scene.render.samples), workers, control)?;
        let mut rendering = self.rendering(&self.scene, &light)?;
        rendering.warnings = self.warnings(&light, &rendering);
        Ok(rendering)
    }

    /// Continues until `samples` samples of each pixel are in the sums, or until `control` asks to stop. A span that was begun before is
    /// finished first, even if it is longer.
    ///
    /// # Errors
    /// Returns [`RenderError::NonFinite`] or [`RenderError::Overflow`] as soon as a ray shows it, but not before the first pass over the
    /// frame is complete; `light` then holds the light of all other rays. Returns [`RenderError::DoesNotExtend`] if the random numbers are laid out for another number of samples.
    pub fn advance(
        &self,
        light: &mut Light,
        samples: u64,
        workers: &dyn Workers,
        control: &Control,
    ) -> Result<(), RenderError> {
        if samples != u64::from(self.scene.render.samples) && self.scene.render.numbers == NumberFamily::Stratified {
            return Err(RenderError::DoesNotExtend("stratified"));
        }
        if !self.meter(light, workers)? {
            return Ok(());
        }
        if self.scene.render.noise.is_none() {
            self.expect(light, samples, control);
            return self.trace(light, samples, workers, control);
        }
        loop {
            let done = light.samples();
            if ends_round(done) && light.judged < done {
                self.end_clean(light, workers)?;
                light.judged = done;
            }
            if done >= samples || self.is_clean(light) || control.should_stop() {
                return Ok(());
            }
            let end = next_round(done).min(samples);
            self.expect(light, end, control);
            self.trace(light, end, workers, control)?;
        }
    }

    /// Traces the first pass over the frame, unless it is complete, or until `control` asks to stop. [`Renderer::advance`] continues it.
    ///
    /// # Errors
    /// Returns the same errors as [`Renderer::advance`].
    pub fn first_pass(&self, light: &mut Light, workers: &dyn Workers, control: &Control) -> Result<(), RenderError> {
        if light.covers_frame() || !self.meter(light, workers)? {
            return Ok(());
        }
        self.expect(light, u64::from(self.scene.render.samples), control);
        self.cover_frame(light, workers, control)
    }

    /// Measures what the meters see, unless it is known. Returns false if the workers were told to stop; the meters then measure again
    /// the next time.
    fn meter(&self, light: &mut Light, workers: &dyn Workers) -> Result<bool, RenderError> {
        if light.metered.is_none() {
            match self.metered(workers) {
                Err(RenderError::Stopped) => return Ok(false),
                metered => light.metered = Some(metered?),
            }
        }
        Ok(true)
    }

    /// Tells the caller how many rays there will be when each pixel has `samples` samples.
    fn expect(&self, light: &Light, samples: u64, control: &Control) {
        let rays = self.estimators().zip(&light.parts).map(|(e, part)| {
            let (samples, tiles) = (samples.div_ceil(part.share), part.done.active(e.tiles()));
            let all = e.rays(&(part.done.complete()..samples.max(part.done.end())), &tiles);
            // Units of an open span that are done have about equally many rays.
            let done = part.done.open().map_or(0.0, |(span, units)| {
                let done = units.ranges().map(|range| range.end - range.start).sum::<u64>();
                e.rays(span, &tiles) as f64 * done as f64 / e.units(span, &tiles).max(1) as f64
            });
            all.saturating_sub(done as u64)
        });
        control.expect(control.rays() + rays.sum::<u64>());
    }

    /// Allocates the light of a render that has not begun.
    ///
    /// # Errors
    /// Returns [`RenderError::Memory`] if the sums do not fit into memory.
    pub fn begin(&self) -> Result<Light, RenderError> {
        let part = |part: &Part| {
            let cells = match part.role {
                Role::Check => self.parts.checks.count().checked_mul(self.recorded().len()),
                Role::All | Role::Half => self.cells().checked_mul(1 + part.estimator.paths().len()),
            };
            let sums = cells.and_then(ExactSums::new).ok_or_else(|| self.too_large())?;
            Ok(EstimatorSums { sums, share: part.share(), done: Done::default(), rays: 0, detected: 0 })
        };
        let parts = self.parts.all.iter().map(part).collect::<Result<_, RenderError>>()?;
        Ok(Light { parts, losses: LossCounts::default(), metered: None, judged: 0, covers_frame: false })
    }

    /// The estimators and their shares of the samples.
    pub(crate) fn parts(&self) -> &Parts {
        &self.parts
    }

    /// One estimator for each kind of light and direction.
    fn kinds(&self) -> impl Iterator<Item = &dyn Estimator> {
        self.parts.firsts().iter().map(|part| &*part.estimator)
    }

    /// Returns whether the light has all samples that the scene states, or is as clean as the scene asks for.
    #[must_use]
    pub fn is_complete(&self, light: &Light) -> bool {
        light.samples() >= u64::from(self.scene.render.samples) || self.is_clean(light)
    }

    /// Whether the requested noise is reached everywhere.
    fn is_clean(&self, light: &Light) -> bool {
        let ended = |(e, part): (&dyn Estimator, &EstimatorSums)| part.done.ended().len() == e.tiles();
        self.scene.render.noise.is_some() && self.estimators().zip(&light.parts).all(ended)
    }

    /// Traces the first pass over the frame, unless it is complete. A faulty ray does not end it.
    fn cover_frame(&self, light: &mut Light, workers: &dyn Workers, control: &Control) -> Result<(), RenderError> {
        if light.covers_frame {
            return Ok(());
        }
        let mut failure = None;
        for at in 0..light.parts.len() {
            let Some(span) = light.parts[at].done.next(1) else { continue };
            if let Err(error) = self.span(at, &span, light, workers, control) {
                failure.get_or_insert(error);
            }
            // The last unit may be complete when the work is told to stop.
            if control.should_stop() && !self.has_first_units(at, light) {
                return failure.map_or(Ok(()), Err);
            }
        }
        light.covers_frame = true;
        failure.map_or(Ok(()), Err)
    }

    /// Returns whether an estimator has done its units of the first pass.
    fn has_first_units(&self, at: usize, light: &Light) -> bool {
        let (Some(estimator), done) = (self.estimators().nth(at), &light.parts[at].done) else { return true };
        let Some((samples, units)) = done.open() else { return done.complete() > 0 };
        let tiles = done.active(estimator.tiles());
        units.covers(first_units(estimator, estimator.units(samples, &tiles)))
    }

    /// Continues until each pixel has `samples` samples, in passes over the whole frame.
    fn trace(
        &self,
        light: &mut Light,
        samples: u64,
        workers: &dyn Workers,
        control: &Control,
    ) -> Result<(), RenderError> {
        self.cover_frame(light, workers, control)?;
        while light.samples() < samples && !light.parts.is_empty() {
            let upto = next_pass(light.samples()).min(samples);
            for at in 0..light.parts.len() {
                if control.should_stop() {
                    return Ok(());
                }
                let part = &mut light.parts[at];
                if let Some(span) = part.done.next(upto.div_ceil(part.share)) {
                    self.span(at, &span, light, workers, control)?;
                }
            }
        }
        Ok(())
    }

    /// Measures what the meters see of the light of all estimators.
    fn metered(&self, workers: &dyn Workers) -> Result<Vec<Vec<f64>>, RenderError> {
        let mut all: Vec<Vec<f64>> = Vec::new();
        if self.scene.meter_channels().is_empty() {
            return Ok(all);
        }
        for estimator in self.kinds() {
            let own = estimator.metered(workers)?;
            if all.is_empty() {
                all = own;
            } else {
                all.iter_mut().flatten().zip(own.iter().flatten()).for_each(|(sum, value)| *sum += value);
            }
        }
        // A picture that is taken as already exposed shows the meter its mid gray.
        for (plane, at) in all.iter_mut().zip(self.scene.meter_channels()) {
            let mut films = self.scene.films.iter().filter(|film| film.channels.contains(&at));
            if films.any(|film| self.scene.uses_source_exposure(film)) {
                let response = &self.scene.channels[at].response;
                let gray = self.scene.source.gray_over_mean(response).unwrap_or(1.0);
                let mean = plane.iter().sum::<f64>() / plane.len().max(1) as f64;
                plane.fill(gray * mean);
            }
        }
        Ok(all)
    }

    /// Returns the exposure of a mid gray of the source in each channel: 0 except in the channels of meters.
    fn mid_gray(&self, planes: &[ExposureChannel]) -> Option<Vec<f32>> {
        let mut all = vec![0.0; planes.len()];
        for at in self.scene.meter_channels() {
            let gray = self.scene.source.gray_over_mean(&self.scene.channels[at].response)?;
            let values = &planes.get(at)?.values;
            let mean = values.iter().map(|v| f64::from(*v)).sum::<f64>() / values.len().max(1) as f64;
            let shown = self.scene.films.iter().any(|f| f.channels.contains(&at) && self.scene.uses_source_exposure(f));
            all[at] = (if shown { mean } else { gray * mean }) as f32;
        }
        Some(all)
    }

    /// Traces the remaining units of a span of one estimator.
    fn span(
        &self,
        at: usize,
        samples: &std::ops::Range<u64>,
        light: &mut Light,
        workers: &dyn Workers,
        control: &Control,
    ) -> Result<(), RenderError> {
        let Some(estimator) = self.estimators().nth(at) else { return Ok(()) };
        let part = &light.parts[at];
        let tiles = part.done.active(estimator.tiles());
        let units = estimator.units(samples, &tiles);
        let is_first_pass = !light.covers_frame;
        let end = if is_first_pass { first_units(estimator, units) } else { units };
        let known = part.done.open().map(|(_, units)| units.clone()).unwrap_or_default();
        // A thread that takes several units at a time gets neighbors, whose light comes from nearby places.
        let run = (units / UNITS_A_RUN).clamp(1, LONGEST_RUN);
        let (next, failed) = (AtomicU64::new(0), AtomicBool::new(false));
        let ends = || control.should_stop() || failed.load(Relaxed) && !is_first_pass;
        let failure: Mutex<Option<RenderError>> = Mutex::new(None);
        let counted = Mutex::new((LossCounts::default(), 0, Units::default(), 0));
        let fail = |error: RenderError| {
            failed.store(true, Relaxed);
            failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        };
        workers.run_on_all(&|| {
            let mut scratch = estimator.scratch();
            let (mut done, mut rays) = (Units::default(), 0);
            while !ends() {
                let first = next.fetch_add(run, Relaxed);
                if first >= end {
                    break;
                }
                for unit in (first..end.min(first + run)).filter(|unit| !known.contains(*unit)) {
                    if ends() {
                        break;
                    }
                    let came = estimator.run(samples, &tiles, unit, &mut scratch, &part.sums);
                    rays += came.rays;
                    control.launched(came.rays);
                    done.insert(unit..unit + 1);
                    came.error.into_iter().for_each(fail);
                    if part.sums.overflowed() {
                        // The sum of a pixel overflowed: there are so many contributions that none of them is to blame.
                        fail(RenderError::Overflow { times: LARGEST_CONTRIBUTION / LARGEST_EXPECTED });
                    }
                }
            }
            scratch.finish(&part.sums);
            if part.sums.overflowed() {
                fail(RenderError::Overflow { times: LARGEST_CONTRIBUTION / LARGEST_EXPECTED });
            }
            let mut all = counted.lock().unwrap_or_else(PoisonError::into_inner);
            all.0.merge(&scratch.0.work.losses);
            all.1 += scratch.0.detected;
            done.ranges().for_each(|range| all.2.insert(range));
            all.3 += rays;
        });
        let (losses, detected, done, rays) = counted.into_inner().unwrap_or_else(PoisonError::into_inner);
        light.losses.merge(&losses);
        let part = &mut light.parts[at];
        part.rays += rays;
        part.detected += detected;
        part.done.note(&done, units);
        failure.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), Err)
    }

    /// Computes the picture so far, as `scene` describes it: the scene itself, or one that differs only in what follows the light.
    ///
    /// # Errors
    /// Returns [`RenderError::Memory`] if the exposure does not fit into memory, and [`RenderError::Diffraction`] if diffraction cannot be
    /// computed.
    pub fn rendering(&self, scene: &Scene, light: &Light) -> Result<Rendering, RenderError> {
        let recorded = &self.pipeline.recorded;
        let time_s = scene.exposure_time_s();
        let weights: Vec<Vec<f64>> = (0..self.parts.kinds).map(|kind| self.weights(kind, light, time_s)).collect();
        let mut planes = self.planes(scene, light, &weights, None)?;
        let mut layers = self.layers(scene, light, &weights)?;
        let star = layers.iter_mut().find(|layer| layer.kind == LightKind::Star);
        let diffraction = if scene.render.diffraction.map_or_else(|| self.is_star_seen(), Ok)? {
            let before = if star.is_some() { planes.clone() } else { Vec::new() };
            let done = diffracted::spread(scene, &mut planes, recorded);
            let done = done.map_err(|fault| RenderError::Diffraction(Box::new(fault)))?;
            for ((star, plane), before) in star.into_iter().flat_map(|s| &mut s.channels).zip(&planes).zip(before) {
                let moved = plane.values.iter().zip(before.values).map(|(now, before)| now - before);
                star.values = moved.collect();
            }
            Some(done)
        } else {
            None
        };
        let size = scene.imager.size();
        let mid_gray = self.mid_gray(&planes);
        Ok(Rendering {
            mid_gray,
            exposure: ExposureFrame { size, channels: planes },
            layers,
            rays: light.rays(),
            losses: light.losses.clone(),
            detected: light.detected(),
            estimators: self.kinds().map(Estimator::name).collect(),
            samples: light.samples(),
            partial: !self.is_complete(light),
            noise: self.noise(light)?,
            ledger: self.ledger.clone(),
            ghost_noise: self.ghost_noise(light.samples()),
            glare: self.glare_of(light, &weights),
            diffraction,
            warnings: Vec::new(),
        })
    }

    /// Returns the factors that turn the sums of both parts of a kind of light, added up, into exposures.
    fn weights(&self, kind: usize, light: &Light, time_s: f64) -> Vec<f64> {
        let sums = || self.parts.of_kind(kind, light).map(|(_, sums)| sums);
        let done: Vec<&Done> = sums().map(|part| &part.done).collect();
        self.parts.all[kind].estimator.weights(&done, sums().map(|part| part.rays).sum(), time_s)
    }

    /// Estimates the noise of ghosts after this many samples.
    fn ghost_noise(&self, samples: u64) -> Option<GhostNoise> {
        const MOST: u64 = 1 << 16;
        let expected = |samples: u64| {
            self.parts.firsts().iter().find_map(|part| {
                let of_part = part.estimator.expected_noise((samples / part.share()).max(1));
                of_part.map(|noise| noise / (part.share() as f64).sqrt())
            })
        };
        let noise = expected(samples)?;
        let more = || std::iter::successors(Some(samples.max(1)), |samples| Some(samples + samples.div_ceil(4)));
        let is_clean = |samples: &u64| expected(*samples).is_some_and(|noise| noise <= GhostNoise::CLEAN);
        let clean_samples =
            if noise > GhostNoise::CLEAN { more().take_while(|samples| *samples <= MOST).find(is_clean) } else { None };
        Some(GhostNoise { noise, clean_samples })
    }

    /// Whether diffraction matters without being requested: if the star of a lamp is bright enough to be seen. Found once.
    fn is_star_seen(&self) -> Result<bool, RenderError> {
        if let Some(seen) = self.is_star_seen.get() {
            return Ok(*seen);
        }
        let seen = match self.parts.firsts() {
            [rest, lights, ..] if self.has_lights => {
                star_trial::is_star_seen(&self.pipeline, &*rest.estimator, &*lights.estimator)?
            }
            _ => false,
        };
        Ok(*self.is_star_seen.get_or_init(|| seen))
    }

    /// Returns the fraction of all light that is veiling glare; `weights` are those of the estimators.
    fn glare_of(&self, light: &Light, weights: &[Vec<f64>]) -> Option<f64> {
        self.scene.render.glare?;
        let channels = self.pipeline.recorded.len();
        let (mut glare, mut all) = (0.0, 0.0);
        for ((part, sums), weights) in self.parts.all.iter().zip(&light.parts).zip(weights.iter().cycle()) {
            let of_place = |p: usize| (0..channels).map(|at| sums.sums.get(p * channels + at) as f64).sum::<f64>();
            let of_pixel = |p: usize| self.parts.place(part, p).map_or(0.0, of_place);
            let own: f64 = weights.iter().enumerate().map(|(p, weight)| weight * of_pixel(p)).sum();
            all += own;
            glare += if part.estimator.name() == veil::ESTIMATOR { own } else { 0.0 };
        }
        (all > 0.0).then_some(glare / all)
    }

    /// The scene that this renderer renders.
    #[must_use]
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The density from which the wavelengths are drawn.
    #[must_use]
    pub fn density(&self) -> &Arc<dyn WavelengthDensity> {
        &self.pipeline.density
    }

    pub(crate) fn recorded(&self) -> &[usize] {
        &self.pipeline.recorded
    }

    pub(crate) fn judged_channels(&self) -> Vec<usize> {
        self.pipeline.judged_channels()
    }

    /// The stages of the scene, ready to trace.
    pub(crate) fn pipeline(&self) -> &Pipeline {
        &self.pipeline
    }

    /// Whether a file of the light itself is asked for.
    pub(crate) fn keeps_light(&self) -> bool {
        self.keeps_light
    }

    /// The medians of the frame, once they are known.
    pub(crate) fn known_medians(&self) -> &OnceLock<Vec<f64>> {
        &self.known_medians
    }

    /// The estimators of all parts.
    pub(crate) fn estimators(&self) -> impl Iterator<Item = &dyn Estimator> {
        self.parts.estimators()
    }

    /// Number of sums for all the light of one estimator: one for each pixel and channel.
    pub(crate) fn cells(&self) -> usize {
        self.scene.imager.size().pixels() * self.pipeline.recorded.len()
    }

    pub(crate) fn too_large(&self) -> RenderError {
        RenderError::Memory(memory_needed(&self.scene))
    }
}
