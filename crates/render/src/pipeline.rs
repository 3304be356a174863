//! Parts that both directions share: the prepared stages, and the buffers of one thread.

use crate::error::RenderError;
use crate::options::RenderOptions;
use crate::response::Responses;
use crate::spots::Before;
use crate::sums::{OwnSteps, OwnSums, rounded};
use spectra_core::batch::Column;
use spectra_core::isa::Vectorized;
use spectra_core::loss::ALIVE;
use spectra_core::numbers::{Dimension, Numbers};
use spectra_core::spectral::SystemResponse;
use spectra_core::stage::{Source, WavelengthDensity};
use spectra_core::{Isa, Loss, RayBatch};
use spectra_optics::{Effort, RearPupil};
use spectra_scene::{LightKind, NumberFamily, Scene};
use spectra_tracer::{Indices, Tracer, Work};
use std::sync::{Arc, OnceLock};

/// The part of a source's light that is traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SourcePart {
    /// All light of the source.
    Whole,
    /// The bright lights of the source: see [`spectra_core::stage::Split`].
    Lights,
    /// All light except that of the bright lights.
    Rest,
}

impl SourcePart {
    /// Returns the source that emits this share of the light.
    pub(crate) fn of(self, scene: &Scene) -> &dyn Source {
        match (self, scene.source.split()) {
            (Self::Lights, Some(split)) => split.lights,
            (Self::Rest, Some(split)) => split.rest,
            _ => &*scene.source,
        }
    }
}

/// The stages of a scene, ready to trace.
#[derive(Clone)]
pub struct Pipeline {
    pub(crate) scene: Arc<Scene>,
    /// Seed of the picture.
    pub(crate) seed: u64,
    /// The part of the source's light that is traced.
    pub(crate) share: SourcePart,
    pub(crate) isa: Isa,
    pub(crate) effort: Effort,
    pub(crate) tracer: Arc<Tracer>,
    /// The pupil that the imager sees, once it is found.
    rear: Arc<OnceLock<Arc<RearPupil>>>,
    pub(crate) density: Arc<dyn WavelengthDensity>,
    pub(crate) responses: Responses,
    /// The channels of the scene that are recorded, in the order of `responses`.
    pub(crate) recorded: Vec<usize>,
    /// Whether a stage draws random numbers of its own, so that batches must carry the data for it.
    pub(crate) draws: bool,
    /// Whether this pipeline traces only light that a layer on the lens scattered at least once. If false, it traces only unscattered
    /// light.
    pub(crate) scattered: bool,
}

/// Name of the estimators of scattered light, in either direction.
pub(crate) const SCATTER: &str = "scatter";
/// Turns the seed into that of scattered light, so that its random numbers differ from those of the other light of the same pixel.
const SCATTER_SEED: u64 = 0x5ca7_7e4e_d11f_7b0d;

impl Pipeline {
    /// Prepares the stages of a scene.
    pub(crate) fn new(scene: &Arc<Scene>, options: &RenderOptions<'_>) -> Result<Self, RenderError> {
        let (isa, effort) = (options.isa, options.effort);
        if let Some(text) = crate::diffracted::fault(scene) {
            return Err(RenderError::Diffraction(Box::new(text)));
        }
        // The channels of meters are not recorded: whether a camera meters must not change the picture's samples.
        let recorded = scene.picture_channels();
        let system = system(scene, SourcePart::Whole, &recorded);
        let fitted =
            || scene.sampler.prepare(&system).map(Arc::from).map_err(|fault| RenderError::Sampler(Box::new(fault)));
        let density = options.density.clone().map_or_else(fitted, Ok)?;
        let tracer = tracer(scene)?;
        let responses = Responses::new(scene.grid, &system.channels);
        let draws = draws(scene);
        let (scene, tracer, share, seed) = (Arc::clone(scene), tracer, SourcePart::Whole, scene.render.seed);
        Ok(Self {
            scene,
            seed,
            share,
            isa,
            effort,
            tracer,
            rear: Arc::default(),
            density,
            responses,
            recorded,
            draws,
            scattered: false,
        })
    }

    /// Returns the kind of straight light that it traces. Light scattered by haze, dust or scratches is stray light.
    pub(crate) fn light(&self) -> LightKind {
        if self.scattered { LightKind::Glare } else { LightKind::Direct }
    }

    /// Returns the divisor of the number of rays with which ghosts are searched and their light is booked.
    pub(crate) fn search_divisor(&self) -> usize {
        match self.effort {
            Effort::Full => 1,
            Effort::Draft => 4,
        }
    }

    /// Returns a copy for a share of the source's light, with its own wavelength density if one can be fitted.
    pub(crate) fn of_share(&self, share: SourcePart) -> Self {
        let system = system(&self.scene, share, &self.recorded);
        let density = self.scene.sampler.prepare(&system).map_or_else(|_| Arc::clone(&self.density), Arc::from);
        Self { share, density, responses: Responses::new(self.scene.grid, &system.channels), ..self.clone() }
    }

    /// Returns a copy for a picture whose rays differ in the seed only.
    pub(crate) fn of_picture(&self, picture: &Arc<Scene>) -> Self {
        Self { scene: Arc::clone(picture), seed: picture.render.seed, ..self.clone() }
    }

    /// Returns the channels in which noise is measured, by their position among the recorded ones: luminance (`Y`) if there is one, else
    /// all.
    pub(crate) fn judged_channels(&self) -> Vec<usize> {
        let mut names = self.recorded.iter().map(|at| self.scene.channels[*at].name.as_str());
        names
            .position(|name| name == "Y")
            .map_or_else(|| (0..self.recorded.len()).collect(), |luminance| vec![luminance])
    }

    /// Returns a copy that traces through another tracer of the lens.
    pub(crate) fn with_tracer(&self, tracer: Arc<Tracer>) -> Self {
        Self { tracer, rear: Arc::default(), ..self.clone() }
    }

    /// Takes over the pupil that the imager sees from the pipeline of another scene, if it does not depend on what differs.
    pub(crate) fn take_pupil(&mut self, earlier: &Self) {
        if self.isa == earlier.isa && self.effort == earlier.effort && self.scene.has_the_view_of(&earlier.scene) {
            self.rear = Arc::clone(&earlier.rear);
        }
    }

    /// Returns the pupil that the imager sees. `search` finds it if it is not known yet, or returns `None` if there is none.
    pub(crate) fn rear_pupil(&self, search: impl FnOnce() -> Option<RearPupil>) -> Option<Arc<RearPupil>> {
        if let Some(known) = self.rear.get() {
            return Some(Arc::clone(known));
        }
        let found = Arc::new(search()?);
        Some(Arc::clone(self.rear.get_or_init(|| found)))
    }

    /// Returns a copy that traces light scattered by haze, dust and scratches on the lens; `None` if nothing lies on it.
    pub(crate) fn scattered(&self) -> Result<Option<Self>, RenderError> {
        if !self.scene.lens.scatters() {
            return Ok(None);
        }
        let tracer = Arc::new(Tracer::clone(&*tracer(&self.scene)?).scattering());
        Ok(Some(Self { draws: true, scattered: true, ..self.with_tracer(tracer) }))
    }

    /// Returns a tracer for the lens with nothing on it that scatters.
    pub(crate) fn clean_tracer(&self) -> Result<Arc<Tracer>, RenderError> {
        tracer(&self.scene)
    }

    /// Returns the source of the light that this pipeline traces.
    pub(crate) fn source(&self) -> &dyn Source {
        self.share.of(&self.scene)
    }

    /// Returns a copy that traces what the meters see, with its own wavelength density; `None` if they see none of the source's light.
    pub(crate) fn of_meters(&self) -> Option<Self> {
        let recorded = self.scene.meter_channels();
        let system = system(&self.scene, self.share, &recorded);
        let density = self.scene.sampler.prepare(&system).ok()?.into();
        let responses = Responses::new(self.scene.grid, &system.channels);
        Some(Self { density, responses, recorded, ..self.clone() })
    }

    /// Returns the random numbers of a seed, of the family that the scene states.
    pub(crate) fn numbers(&self, seed: u64) -> Numbers {
        let seed = if self.scattered { seed ^ SCATTER_SEED } else { seed };
        match self.scene.render.numbers {
            NumberFamily::Sobol => Numbers::sobol(seed),
            NumberFamily::Lattice => Numbers::lattice(seed),
            NumberFamily::Random => Numbers::random(seed),
            NumberFamily::Stratified => Numbers::stratified(seed, self.scene.render.samples),
        }
    }

    /// Returns the number of consecutive samples that share one rotated number of a dimension: more than one for wavelengths only.
    pub(crate) fn group(&self, dimension: usize) -> u32 {
        if dimension == Dimension::Wavelength as usize { self.density.group() } else { 1 }
    }
}

/// Prepares the lens of a scene for its band.
fn tracer(scene: &Scene) -> Result<Arc<Tracer>, RenderError> {
    let indices = Indices::Band { min_nm: scene.grid.start_nm, max_nm: scene.grid.end_nm() };
    scene.lens.tracer(indices).map_err(|e| RenderError::Lens(e.to_string()))
}

/// Whether any stage draws random numbers of its own.
fn draws(scene: &Scene) -> bool {
    scene.lens.elements.iter().any(|e| e.surface.draws())
        || scene.source.emit().is_some_and(|emit| emit.draws())
        || scene.source.radiance().is_some_and(|radiance| radiance.draws())
        || scene.imager.launch().is_some_and(|launch| launch.draws())
        || scene.imager.receive().is_some_and(|receive| receive.draws())
}

/// Returns the spectrum of a share of the source and the responses of the recorded channels.
fn system(scene: &Scene, share: SourcePart, recorded: &[usize]) -> SystemResponse {
    let channels = recorded.iter().filter_map(|at| scene.channels.get(*at)).cloned().collect();
    SystemResponse { grid: scene.grid, source: share.of(scene).spectrum().clone(), channels }
}

/// The buffers of one thread.
pub(crate) struct ThreadState {
    pub rays: RayBatch,
    pub work: Work,
    pub numbers: [Column<f64>; 5],
    pub values: Vec<f64>,
    pub integers: Vec<Vec<i64>>,
    /// Sums of this thread that were not yet added to the shared sums, for an estimator whose rays add to single pixels.
    pub own: Option<OwnSums>,
    /// Sums of this thread that were not yet added to the shared sums, for an estimator whose rays add to rows of pixels.
    pub steps: Option<OwnSteps>,
    /// Rays as they left the lens, for an estimator that spreads their light.
    pub before: Before,
    /// Number of rays that brought light to the imager.
    pub detected: u64,
}

impl Default for ThreadState {
    /// Returns buffers without room for a ray.
    fn default() -> Self {
        Self::of(RayBatch::new(0), Work::default(), 0, 0)
    }
}

impl ThreadState {
    pub(crate) fn new(pipeline: &Pipeline, capacity: usize) -> Self {
        let rays = RayBatch::new(capacity).on(pipeline.isa);
        let rays = if pipeline.tracer.polarizes() { rays.with_polarization() } else { rays };
        let rays = if pipeline.draws { rays.with_numbers() } else { rays };
        Self::of(rays, pipeline.tracer.work_for_light(capacity), capacity, pipeline.responses.channels())
    }

    /// Allocates buffers for `capacity` rays and this number of recorded channels.
    fn of(rays: RayBatch, work: Work, capacity: usize, channels: usize) -> Self {
        Self {
            rays,
            work,
            numbers: std::array::from_fn(|_| Column::new(capacity)),
            values: vec![0.0; capacity],
            integers: vec![vec![0; capacity]; channels],
            own: None,
            steps: None,
            before: Before::default(),
            detected: 0,
        }
    }

    /// Draws `len` wavelengths by the first column of random numbers into a restarted batch.
    pub(crate) fn draw_wavelengths(&mut self, pipeline: &Pipeline, len: usize) {
        self.rays.restart(len);
        let u = self.numbers[Dimension::Wavelength as usize].slice(len);
        let c = self.rays.columns_mut();
        pipeline.density.draw(u, c.wavelength_nm, c.line, c.weight, pipeline.isa);
    }

    /// Sets the weight of the rays that ended to 0. Counts as lost those that ended outside the lens (the lens counts its own) and those
    /// that carry no light; counts the others as detected.
    pub(crate) fn settle(&mut self, isa: Isa) {
        let c = self.rays.columns_mut();
        let Settled { lit, alive, beside_lens } = isa.run(Settle { state: c.state, weight: c.weight });
        self.detected += lit;
        if lit < alive {
            self.work.losses.add(Loss::Unlit, 0, alive - lit);
        }
        if beside_lens > 0 {
            for cause in Loss::ALL {
                let ended = self.rays.states().iter().filter(|s| **s == cause.state(0)).count();
                self.work.losses.add(cause, 0, ended as u64);
            }
        }
    }

    /// Counts as lost and drops the rays that could not be aimed, because nothing passes from where they start.
    pub(crate) fn drop_dark(&mut self, dark: usize) {
        if dark > 0 {
            self.work.losses.add_states(self.rays.states());
            self.rays.compact();
        }
    }

    /// Returns the largest contribution of the batch to any channel.
    pub(crate) fn largest(&mut self, pipeline: &Pipeline) -> f64 {
        let len = self.rays.len();
        let mut largest = 0.0_f64;
        for channel in 0..pipeline.responses.channels() {
            let values = &mut self.values[..len];
            pipeline.isa.run(pipeline.responses.weigh(
                channel,
                self.rays.wavelengths_nm(),
                self.rays.weights(),
                values,
            ));
            largest = values.iter().fold(largest, |a, v| a.max(v.abs()));
        }
        largest
    }

    /// Returns the sum of what all rays of the batch contribute to all channels.
    pub(crate) fn sum(&mut self, pipeline: &Pipeline) -> f64 {
        let len = self.rays.len();
        let mut sum = 0.0;
        for channel in 0..pipeline.responses.channels() {
            let values = &mut self.values[..len];
            let (nm, weights) = (self.rays.wavelengths_nm(), self.rays.weights());
            pipeline.isa.run(pipeline.responses.weigh(channel, nm, weights, values));
            sum += values.iter().sum::<f64>();
        }
        sum
    }

    /// Writes each ray's contribution to each channel as integers. Returns false if one does not fit.
    pub(crate) fn contributions(&mut self, pipeline: &Pipeline, scale: f64) -> bool {
        let (nm, weights) = (self.rays.wavelengths_nm(), self.rays.weights());
        pipeline.isa.run(pipeline.responses.count(nm, weights, scale, &mut self.integers))
    }

    /// Writes the contributions of a batch in which some do not fit. A ray with such a contribution adds nothing to any channel.
    pub(crate) fn contributions_that_fit(&mut self, pipeline: &Pipeline, scale: f64) {
        let len = self.rays.len();
        for channel in 0..pipeline.responses.channels() {
            let values = &mut self.values[..len];
            let (nm, weights) = (self.rays.wavelengths_nm(), self.rays.weights());
            pipeline.isa.run(pipeline.responses.weigh(channel, nm, weights, values));
            let weights = self.rays.weight_columns().weight.iter_mut().zip(values);
            weights.filter(|(_, value)| !rounded(**value * scale).1).for_each(|(weight, _)| *weight = 0.0);
        }
        self.contributions(pipeline, scale);
    }
}

/// Counts of the rays of a batch by their state.
struct Settled {
    /// Rays that are alive and have a weight.
    lit: u64,
    alive: u64,
    /// Rays that ended, but not at a surface of the lens.
    beside_lens: u64,
}

struct Settle<'a> {
    state: &'a [u64],
    weight: &'a mut [f64],
}

impl Vectorized for Settle<'_> {
    type Output = Settled;
    #[inline(always)]
    fn run(self) -> Settled {
        let (mut lit, mut alive, mut beside_lens) = (0, 0, 0);
        for (state, weight) in self.state.iter().zip(self.weight) {
            let is_alive = *state == ALIVE;
            let kept = if is_alive { *weight } else { 0.0 };
            *weight = kept;
            lit += u64::from(kept != 0.0);
            alive += u64::from(is_alive);
            // The state holds the cause in its low byte and the surface above it.
            beside_lens += u64::from((*state != ALIVE) & (*state < 0x100));
        }
        Settled { lit, alive, beside_lens }
    }
}
