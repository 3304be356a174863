//! Measures the spectral integral alone: draws wavelengths and evaluates source and responses, without a lens.

use crate::colors::White;
use crate::report::NumberKind;
use spectra_core::Isa;
use spectra_core::batch::CONTINUUM;
use spectra_core::numbers::{Dimension, Numbers};
use spectra_core::spectral::SystemResponse;
use spectra_core::stage::WavelengthDensity;
use std::time::Instant;

/// Errors measured at one number of samples.
#[derive(Debug)]
pub(crate) struct Measured {
    /// Squared relative error, averaged over channels, for each seed.
    pub squared: Vec<f64>,
    /// Relative error of each channel's light, for each seed.
    pub relative: Vec<Vec<f64>>,
    /// Relative variance of the reference, for each channel.
    pub truth_variance: Vec<f64>,
    /// Shortest time over the seeds for all samples, s.
    pub seconds: f64,
    /// Mean CIEDE2000 over the seeds, if the channels are X, Y, Z.
    pub ciede2000: Option<f64>,
}

/// Returns the exact exposure of each channel by quadrature: the truth.
pub(crate) fn exact(system: &SystemResponse) -> Vec<f64> {
    system.channels.iter().map(|c| system.source.seen_by(&c.response)).collect()
}

/// Kind, count and seeds of the numbers to draw.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Draws {
    pub kind: NumberKind,
    pub samples: u32,
    pub seeds: usize,
    pub first_seed: u64,
}

/// Integrates with wavelengths drawn from `density`. `seen` are the channels that see any of the light; `xyz` are those that are X, Y, Z.
pub(crate) fn measure(
    system: &SystemResponse,
    density: &dyn WavelengthDensity,
    seen: &[usize],
    xyz: Option<[usize; 3]>,
    draws: Draws,
    isa: Isa,
) -> Measured {
    let exact = exact(system);
    let white = xyz.and_then(|c| White::new(c.map(|c| exact[c]), exact[c[1]]));
    let many = draws.samples as usize;
    let mut columns = Columns::new(many);
    let mut estimates = vec![0.0; system.channels.len()];
    let mut measured = Measured {
        squared: Vec::with_capacity(draws.seeds),
        relative: vec![Vec::with_capacity(draws.seeds); seen.len()],
        truth_variance: vec![0.0; seen.len()],
        seconds: f64::INFINITY,
        ciede2000: None,
    };
    let mut differences = 0.0;
    for seed in 0..draws.seeds as u64 {
        let seed = draws.first_seed.wrapping_add(seed);
        let numbers = match draws.kind {
            NumberKind::Sobol => Numbers::sobol(seed),
            NumberKind::Lattice => Numbers::lattice(seed),
            NumberKind::Random => Numbers::random(seed),
            NumberKind::Stratified => Numbers::stratified(seed, draws.samples),
        };
        let begun = Instant::now();
        columns.draw(&numbers, density, isa);
        columns.expose(system, &mut estimates);
        measured.seconds = measured.seconds.min(begun.elapsed().as_secs_f64());
        let mut squares = 0.0;
        for (relative, channel) in measured.relative.iter_mut().zip(seen) {
            let error = estimates[*channel] / exact[*channel] - 1.0;
            relative.push(error);
            squares += error * error;
        }
        measured.squared.push(squares / seen.len() as f64);
        if let (Some(white), Some(c)) = (&white, xyz) {
            differences += white.difference(c.map(|c| estimates[c]), c.map(|c| exact[c]));
        }
    }
    measured.ciede2000 = white.map(|_| differences / draws.seeds as f64);
    measured
}

/// The samples of one integral.
struct Columns {
    u: Vec<f64>,
    wavelength_nm: Vec<f64>,
    line: Vec<u32>,
    weight: Vec<f64>,
}

impl Columns {
    fn new(many: usize) -> Self {
        Self { u: vec![0.0; many], wavelength_nm: vec![0.0; many], line: vec![0; many], weight: vec![0.0; many] }
    }

    fn draw(&mut self, numbers: &Numbers, density: &dyn WavelengthDensity, isa: Isa) {
        numbers.fill_rotated(isa, 0, 0, density.group(), Dimension::Wavelength as u32, &mut self.u);
        self.weight.fill(1.0);
        density.draw(&self.u, &mut self.wavelength_nm, &mut self.line, &mut self.weight, isa);
    }

    /// Computes for each channel the mean over samples of source times response.
    fn expose(&mut self, system: &SystemResponse, estimates: &mut [f64]) {
        let (grid, source) = (system.grid, &system.source);
        for ((weight, line), nm) in self.weight.iter_mut().zip(&self.line).zip(&self.wavelength_nm) {
            *weight *= if *line == CONTINUUM {
                grid.interpolate(&source.continuum, *nm)
            } else {
                source.lines.get(*line as usize).map_or(0.0, |l| l.power)
            };
        }
        for (estimate, channel) in estimates.iter_mut().zip(system.channels.iter()) {
            let rays = self.weight.iter().zip(&self.wavelength_nm);
            let sum: f64 = rays.map(|(weight, nm)| weight * grid.interpolate(&channel.response, *nm)).sum();
            *estimate = sum / self.weight.len() as f64;
        }
    }
}
