//! What both directions share: the stages made ready, and one thread's columns.

use crate::error::RenderError;
use crate::response::Responses;
use crate::spots::Before;
use crate::sums::{OwnSteps, OwnSums};
use spectra_core::batch::Column;
use spectra_core::isa::Vectorized;
use spectra_core::loss::ALIVE;
use spectra_core::numbers::{Dimension, Numbers};
use spectra_core::spectral::SystemResponse;
use spectra_core::stage::{Source, WavelengthDensity};
use spectra_core::{Isa, Loss, RayBatch};
use spectra_lens::{Effort, Indices, Tracer, Work};
use spectra_scene::{NumberFamily, Scene};
use std::sync::Arc;

/// Which light of a source is traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Share {
    /// All.
    Whole,
    /// That of its lights: see [`spectra_core::stage::Split`].
    Lights,
    /// All but that.
    Rest,
}

impl Share {
    /// The source that stands for it.
    pub(crate) fn of(self, scene: &Scene) -> &dyn Source {
        match (self, scene.source.split()) {
            (Self::Lights, Some(split)) => split.lights,
            (Self::Rest, Some(split)) => split.rest,
            _ => &*scene.source,
        }
    }
}

/// The stages, made ready for one scene.
#[derive(Clone)]
pub struct Pipeline {
    pub(crate) scene: Arc<Scene>,
    /// The seed of the picture: the scene's, unless the renderer was reseeded.
    pub(crate) seed: u64,
    /// Which light of the source is traced.
    pub(crate) share: Share,
    pub(crate) isa: Isa,
    pub(crate) effort: Effort,
    pub(crate) tracer: Arc<Tracer>,
    pub(crate) density: Arc<dyn WavelengthDensity>,
    pub(crate) responses: Responses,
    /// Which channels of the scene are recorded, in the order of `responses`.
    pub(crate) recorded: Vec<usize>,
    /// Whether a stage on the way draws numbers of its own, for which batches carry what it needs.
    pub(crate) draws: bool,
    /// Whether it traces light that layers on the lens scatter at least once, in place of what none of them does.
    pub(crate) scattered: bool,
}

/// What an estimator of scattered light is called, in either direction.
pub(crate) const SCATTER: &str = "scatter";
/// Its numbers are none of those of the other light of the same pixel.
const SCATTER_SEED: u64 = 0x5ca7_7e4e_d11f_7b0d;

impl Pipeline {
    /// With this density of wavelengths, where one is known to fit.
    pub(crate) fn new(
        scene: &Arc<Scene>,
        isa: Isa,
        density: Option<Arc<dyn WavelengthDensity>>,
        effort: Effort,
    ) -> Result<Self, RenderError> {
        if let Some(text) = crate::diffracted::fault(scene) {
            return Err(RenderError::Diffraction(text));
        }
        // A meter's channel is none of them: whether a camera meters must not change the picture's samples.
        let recorded = scene.picture_channels();
        let system = system(scene, Share::Whole, &recorded);
        let fitted = || scene.sampler.prepare(&system).map(Arc::from).map_err(RenderError::Sampler);
        let density = density.map_or_else(fitted, Ok)?;
        let tracer = tracer(scene, isa)?;
        let responses = Responses::new(scene.grid, &system.channels);
        let draws = draws(scene);
        let (scene, tracer, share, seed) = (Arc::clone(scene), Arc::new(tracer), Share::Whole, scene.render.seed);
        Ok(Self { scene, seed, share, isa, effort, tracer, density, responses, recorded, draws, scattered: false })
    }

    /// What the number of rays that ghosts are searched and booked with is divided by.
    pub(crate) fn search_divisor(&self) -> usize {
        match self.effort {
            Effort::Full => 1,
            Effort::Draft => 4,
        }
    }

    /// The same for a share of the source, with a density of its own where one can be fitted to it.
    pub(crate) fn of_share(&self, share: Share) -> Self {
        let system = system(&self.scene, share, &self.recorded);
        let density = self.scene.sampler.prepare(&system).map_or_else(|_| Arc::clone(&self.density), Arc::from);
        Self { share, density, responses: Responses::new(self.scene.grid, &system.channels), ..self.clone() }
    }

    /// The same stages for a picture of another seed.
    pub(crate) fn of_seed(&self, seed: u64) -> Self {
        Self { seed, ..self.clone() }
    }

    /// Channels that noise is asked of, by their place among those recorded: luminance where there is one, else all.
    pub(crate) fn judged_channels(&self) -> Vec<usize> {
        let mut names = self.recorded.iter().map(|at| self.scene.channels[*at].name.as_str());
        names
            .position(|name| name == "Y")
            .map_or_else(|| (0..self.recorded.len()).collect(), |luminance| vec![luminance])
    }

    /// The same through a lens that is made ready otherwise.
    pub(crate) fn with_tracer(&self, tracer: Tracer) -> Self {
        Self { tracer: Arc::new(tracer), ..self.clone() }
    }

    /// The same for light that haze, dust and scratches on the lens scatter; `None` where nothing lies on it.
    pub(crate) fn scattered(&self) -> Result<Option<Self>, RenderError> {
        if !self.scene.lens.scatters() {
            return Ok(None);
        }
        let tracer = tracer(&self.scene, self.isa)?.scattering();
        Ok(Some(Self { draws: true, scattered: true, ..self.with_tracer(tracer) }))
    }

    /// The lens as if nothing lay on it that scatters.
    pub(crate) fn clean_tracer(&self) -> Result<Tracer, RenderError> {
        tracer(&self.scene, self.isa)
    }

    /// What is traced of the source.
    pub(crate) fn source(&self) -> &dyn Source {
        self.share.of(&self.scene)
    }

    /// The same for what the meters see, with a density of their own; `None` where they see nothing of the source.
    pub(crate) fn of_meters(&self) -> Option<Self> {
        let recorded = self.scene.meter_channels();
        let system = system(&self.scene, self.share, &recorded);
        let density = self.scene.sampler.prepare(&system).ok()?.into();
        let responses = Responses::new(self.scene.grid, &system.channels);
        Some(Self { density, responses, recorded, ..self.clone() })
    }

    /// The numbers of a seed, as the scene wants them.
    pub(crate) fn numbers(&self, seed: u64) -> Numbers {
        let seed = if self.scattered { seed ^ SCATTER_SEED } else { seed };
        match self.scene.render.numbers {
            NumberFamily::Sobol => Numbers::sobol(seed),
            NumberFamily::Lattice => Numbers::lattice(seed),
            NumberFamily::Random => Numbers::random(seed),
            NumberFamily::Stratified => Numbers::stratified(seed, self.scene.render.samples),
        }
    }

    /// How many samples in a row share one number of a dimension, rotated: only wavelengths ever do.
    pub(crate) fn group(&self, dimension: usize) -> u32 {
        if dimension == Dimension::Wavelength as usize { self.density.group() } else { 1 }
    }
}

/// The lens of a scene, made ready for its band.
fn tracer(scene: &Scene, isa: Isa) -> Result<Tracer, RenderError> {
    let indices = Indices::Band { min_nm: scene.grid.start_nm, max_nm: scene.grid.end_nm() };
    Tracer::new(&scene.lens, indices, isa).map_err(|e| RenderError::Lens(e.to_string()))
}

/// Whether any stage draws.
fn draws(scene: &Scene) -> bool {
    scene.lens.elements.iter().any(|e| e.surface.draws())
        || scene.source.emit().is_some_and(|emit| emit.draws())
        || scene.source.radiance().is_some_and(|radiance| radiance.draws())
        || scene.imager.launch().is_some_and(|launch| launch.draws())
        || scene.imager.receive().is_some_and(|receive| receive.draws())
}

/// The source, and some of the channels.
fn system(scene: &Scene, share: Share, recorded: &[usize]) -> SystemResponse {
    let channels = recorded.iter().filter_map(|at| scene.channels.get(*at)).cloned().collect();
    SystemResponse { grid: scene.grid, source: share.of(scene).spectrum().clone(), channels }
}

/// Columns of one thread.
pub(crate) struct ThreadState {
    pub rays: RayBatch,
    pub work: Work,
    pub numbers: [Column<f64>; 5],
    pub values: Vec<f64>,
    pub integers: Vec<Vec<i64>>,
    /// What was summed and not yet added to the sums of all threads, of an estimator that sums so.
    pub own: Option<OwnSums>,
    /// The same of an estimator whose rays add to pixels in a row.
    pub steps: Option<OwnSteps>,
    /// Rays as they came from the lens, of an estimator that spreads their light.
    pub before: Before,
    /// Rays that brought light to the imager.
    pub detected: u64,
}

impl ThreadState {
    pub(crate) fn new(pipeline: &Pipeline, capacity: usize) -> Self {
        let rays = RayBatch::new(capacity);
        let rays = if pipeline.tracer.polarizes() { rays.with_polarization() } else { rays };
        Self {
            rays: if pipeline.draws { rays.with_numbers() } else { rays },
            work: pipeline.tracer.work_for_light(capacity),
            numbers: std::array::from_fn(|_| Column::new(capacity)),
            values: vec![0.0; capacity],
            integers: vec![vec![0; capacity]; pipeline.responses.channels()],
            own: None,
            steps: None,
            before: Before::default(),
            detected: 0,
        }
    }

    /// Draws `len` wavelengths by the first column of numbers, into a batch that starts over.
    pub(crate) fn draw_wavelengths(&mut self, pipeline: &Pipeline, len: usize) {
        self.rays.restart(len);
        let u = self.numbers[Dimension::Wavelength as usize].slice(len);
        let c = self.rays.columns_mut();
        pipeline.density.draw(u, c.wavelength_nm, c.line, c.weight, pipeline.isa);
    }

    /// Takes the weight from the rays that ended. Books those that ended at no surface of the lens (the lens has booked its
    /// own), and those that carry no light; counts the others as detected.
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

    /// Books and drops the rays that were not even aimed: nothing passes from where they start.
    pub(crate) fn drop_dark(&mut self, dark: usize) {
        if dark > 0 {
            self.work.losses.add_states(self.rays.states());
            self.rays.compact();
        }
    }

    /// The largest contribution of the batch to any channel.
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

    /// What all rays of the batch contribute to all channels.
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

    /// Writes each ray's contribution to each channel as integers; false where one does not fit.
    pub(crate) fn contributions(&mut self, pipeline: &Pipeline, scale: f64) -> bool {
        let (nm, weights) = (self.rays.wavelengths_nm(), self.rays.weights());
        pipeline.isa.run(pipeline.responses.count(nm, weights, scale, &mut self.integers))
    }
}

/// How many rays of a batch are what.
struct Settled {
    /// Alive, with a weight.
    lit: u64,
    alive: u64,
    /// Ended, at no surface of the lens.
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
            // Cause in the low byte, surface above it.
            beside_lens += u64::from((*state != ALIVE) & (*state < 0x100));
        }
        Settled { lit, alive, beside_lens }
    }
}
