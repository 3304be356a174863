//! What both directions share: the stages made ready, and one thread's columns.

use crate::error::RenderError;
use crate::response::Responses;
use crate::sums::Round;
use spectra_core::batch::Column;
use spectra_core::isa::Vectorized;
use spectra_core::loss::ALIVE;
use spectra_core::numbers::{Dimension, Numbers};
use spectra_core::spectral::SystemResponse;
use spectra_core::stage::WavelengthDensity;
use spectra_core::{Isa, RayBatch};
use spectra_lens::{Indices, Tracer, Work};
use spectra_scene::{NumberFamily, Scene};

/// The stages, made ready for one scene.
pub(crate) struct Pipeline<'a> {
    pub scene: &'a Scene,
    pub isa: Isa,
    pub tracer: Tracer,
    pub density: Box<dyn WavelengthDensity>,
    pub responses: Responses,
}

impl<'a> Pipeline<'a> {
    pub(crate) fn new(scene: &'a Scene, isa: Isa) -> Result<Self, RenderError> {
        let system = SystemResponse {
            grid: scene.grid,
            source: scene.source.spectrum().clone(),
            channels: scene.channels.clone(),
        };
        let density = scene.sampler.prepare(&system).map_err(RenderError::Sampler)?;
        let indices = Indices::Band { min_nm: scene.grid.start_nm, max_nm: scene.grid.end_nm() };
        Ok(Self {
            scene,
            isa,
            tracer: Tracer::new(&scene.lens, indices, isa).map_err(|e| RenderError::Lens(e.to_string()))?,
            density,
            responses: Responses::new(scene.grid, &scene.channels),
        })
    }

    /// The numbers of a seed, as the scene wants them.
    pub(crate) fn numbers(&self, seed: u64) -> Numbers {
        match self.scene.render.numbers {
            NumberFamily::Sobol => Numbers::sobol(seed),
            NumberFamily::Random => Numbers::random(seed),
            NumberFamily::Stratified => Numbers::stratified(seed, self.scene.render.samples),
        }
    }

    /// How many samples in a row share one number of a dimension, rotated: only wavelengths ever do.
    pub(crate) fn group(&self, dimension: usize) -> u32 {
        if dimension == Dimension::Wavelength as usize { self.density.group() } else { 1 }
    }
}

/// Columns of one thread.
pub(crate) struct ThreadState {
    pub rays: RayBatch,
    pub work: Work,
    pub numbers: [Column<f64>; 5],
    pub values: Vec<f64>,
    pub integers: Vec<Vec<i64>>,
}

impl ThreadState {
    pub(crate) fn new(pipeline: &Pipeline<'_>, capacity: usize) -> Self {
        Self {
            rays: RayBatch::new(capacity),
            work: pipeline.tracer.work(capacity),
            numbers: std::array::from_fn(|_| Column::new(capacity)),
            values: vec![0.0; capacity],
            integers: vec![vec![0; capacity]; pipeline.responses.channels()],
        }
    }

    /// Draws `len` wavelengths by the first column of numbers, into a batch that starts over.
    pub(crate) fn draw_wavelengths(&mut self, pipeline: &Pipeline<'_>, len: usize) {
        self.rays.restart(len);
        let u = self.numbers[Dimension::Wavelength as usize].slice(len);
        let c = self.rays.columns_mut();
        pipeline.density.draw(u, c.wavelength_nm, c.line, c.weight, pipeline.isa);
    }

    /// Takes the weight from the rays that ended.
    pub(crate) fn silence_ended(&mut self, isa: Isa) {
        let c = self.rays.columns_mut();
        isa.run(Silence { state: c.state, weight: c.weight });
    }

    /// Books and drops the rays that were not even aimed: nothing passes from where they start.
    pub(crate) fn drop_dark(&mut self, dark: usize) {
        if dark > 0 {
            self.work.losses.add_states(self.rays.states());
            self.rays.compact();
        }
    }

    /// The largest contribution of the batch to any channel.
    pub(crate) fn largest(&mut self, pipeline: &Pipeline<'_>) -> f64 {
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

    /// Writes each ray's contribution to each channel as integers; false where one does not fit.
    pub(crate) fn contributions(&mut self, pipeline: &Pipeline<'_>, scale: f64) -> bool {
        let len = self.rays.len();
        let mut good = true;
        for (channel, integers) in self.integers.iter_mut().enumerate() {
            let values = &mut self.values[..len];
            pipeline.isa.run(pipeline.responses.weigh(
                channel,
                self.rays.wavelengths_nm(),
                self.rays.weights(),
                values,
            ));
            good &= pipeline.isa.run(Round { values, scale, out: &mut integers[..len] });
        }
        good
    }
}

struct Silence<'a> {
    state: &'a [u64],
    weight: &'a mut [f64],
}

impl Vectorized for Silence<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for (state, weight) in self.state.iter().zip(self.weight) {
            *weight = if *state == ALIVE { *weight } else { 0.0 };
        }
    }
}
