//! Runs the benchmark: every strategy, every number of samples, every seed.

use crate::every_factor::{EveryFactor, needs_wavelength};
use crate::frame::{RENDERS, Truth, renders};
use crate::integral::{Draws, Measured, exact, measure};
use crate::report::{ChannelBias, LeftOut, Measure, NumberKind, OfSeed, Point, Reference, Report, Series};
use crate::statistics::{fit, in_standard_errors, mean_and_variance_of_mean};
use crate::strategy::{SceneDefaults, Strategy, all, resolve};
use crate::{BenchError, colors};
use spectra_core::Isa;
use spectra_core::spectral::{Channel, SystemResponse};
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};
use spectra_scene::{Direction, NumberFamily, Scene};
use std::path::Path;
use std::sync::Arc;

/// Settings of a benchmark.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Number of seeds of each render, at least 2.
    pub seeds: usize,
    /// Number of seeds of each integral, at least 2. An integral is so much faster than a render that it can have many more.
    pub integral_seeds: usize,
    /// Seed from which all others are derived; that of the scene if `None`.
    pub seed: Option<u64>,
    /// Numbers of samples, each from 1 to 2^20. Powers of two keep Sobol points evenly distributed.
    pub samples: Vec<u32>,
    /// Strategies to measure. The first is the one that the others are compared with. All registered strategies if empty.
    pub strategies: Vec<Strategy>,
    /// Whether to render the scene as well; otherwise only the integral is measured.
    pub render: bool,
    /// Channels to record instead of those of the scene's imager or films, on the scene's grid. If given, only the integral is
    /// measured, because no imager of the scene has these channels.
    pub response: Option<Vec<Channel>>,
    /// Number of threads for rendering.
    pub threads: usize,
    /// Instruction set to use.
    pub isa: Isa,
}

/// Largest number of samples.
const MOST: u32 = 1 << 20;

/// Distance between the first seeds of consecutive numbers of samples, so that none is used twice.
const SEED_STRIDE: u64 = 1 << 32;

/// Measures the strategies on a scene file with `overrides` (texts `path=value`). `tell` receives a line about the current measurement now
/// and then.
///
/// # Errors
/// [`BenchError`]: invalid settings, scene or strategies, no recorded light, or a failed render.
pub fn bench(
    path: &Path,
    overrides: &[String],
    settings: &Settings,
    tell: &mut dyn FnMut(&str),
) -> Result<Report, BenchError> {
    let samples = checked(settings)?;
    let scene = crate::scene::load(path, overrides)?;
    let mut run = Run::prepare(&scene, path, overrides, settings, samples, tell)?;
    let mut series = Vec::new();
    let (own, other) = match scene.render.numbers {
        NumberFamily::Sobol => (NumberKind::Sobol, NumberKind::Random),
        NumberFamily::Lattice => (NumberKind::Lattice, NumberKind::Random),
        NumberFamily::Random => (NumberKind::Random, NumberKind::Sobol),
        NumberFamily::Stratified => (NumberKind::Stratified, NumberKind::Random),
    };
    for kind in [own, other] {
        tell(&format!("{}: spectral integral, {} numbers", scene.name, kind.name()));
        related(&mut series, run.entrants.iter().map(|e| run.integral(e, kind)));
    }
    let mut reference = None;
    if settings.render && settings.response.is_none() {
        reference = Some(run.scene(own, &mut series, tell)?);
    }
    let size = scene.imager.size();
    Ok(Report {
        scene: scene.name.clone(),
        seed: run.first_seed,
        source: scene.source.describe(),
        lens: scene.lens.name.clone(),
        channels: run.names.clone(),
        width_px: size.width_px,
        height_px: size.height_px,
        direction: if scene.render.direction == Direction::Forward { "forward" } else { "backward" },
        threads: settings.threads,
        isa: settings.isa.name(),
        intervals: "95 %, percentiles of 1000 bootstrap resamples of the seeds",
        reference,
        series,
        left_out: run.left_out,
    })
}

/// Returns the numbers of samples in ascending order without duplicates. Checks these numbers and the number of seeds.
fn checked(settings: &Settings) -> Result<Vec<u32>, BenchError> {
    let mut samples = settings.samples.clone();
    samples.sort_unstable();
    samples.dedup();
    if samples.is_empty() || samples.iter().any(|n| !(1..=MOST).contains(n)) {
        return Err(BenchError::Settings("samples: give at least one number, each from 1 to 1048576"));
    }
    if settings.seeds < 2 || settings.integral_seeds < 2 {
        return Err(BenchError::Settings("seeds: give at least 2, because errors are judged by their scatter"));
    }
    Ok(samples)
}

/// A strategy with its scene and its fitted wavelength density.
struct Entrant {
    strategy: Strategy,
    scene: Scene,
    density: Shared,
}

/// A wavelength density shared by all renders of the scene. It is fitted only once, because a fit of Gaussian terms takes longer than a
/// small render.
#[derive(Clone)]
struct Shared(Arc<dyn WavelengthDensity>);

impl WavelengthSampler for Shared {
    fn prepare(&self, _system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, spectra_core::params::Fault> {
        Ok(Box::new(self.clone()))
    }
}

impl WavelengthDensity for Shared {
    fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], line: &mut [u32], weight: &mut [f64], isa: Isa) {
        self.0.draw(u, wavelength_nm, line, weight, isa);
    }

    fn density_per_nm(&self, wavelength_nm: f64) -> f64 {
        self.0.density_per_nm(wavelength_nm)
    }

    fn line_probability(&self, line: usize) -> f64 {
        self.0.line_probability(line)
    }

    fn group(&self) -> u32 {
        self.0.group()
    }
}

struct Run<'a> {
    settings: &'a Settings,
    samples: Vec<u32>,
    system: SystemResponse,
    /// Channels that see any of the light.
    seen: Vec<usize>,
    names: Vec<String>,
    first_seed: u64,
    entrants: Vec<Entrant>,
    left_out: Vec<LeftOut>,
}

/// Prepares the strategy that draws one term of every factor, or says why the scene needs a wavelength.
fn every_factor(
    strategy: &Strategy,
    scene: &Scene,
    system: &SystemResponse,
    settings: &Settings,
    tell: &mut dyn FnMut(&str),
) -> Result<Result<Entrant, String>, BenchError> {
    let every = match EveryFactor::new(system, strategy.terms()?) {
        Ok(every) => every,
        Err(reason) => return Ok(Err(reason)),
    };
    // Skip the check if only the integral is measured, because then no scene is traced.
    if settings.render
        && settings.response.is_none()
        && let Some(reason) = needs_wavelength(scene, system, settings.threads, settings.isa)?
    {
        return Ok(Err(reason));
    }
    let (mean, deviation) = every.moments();
    tell(&format!("{}: over all choices, a sample scatters by {:.4} of the mean", strategy.label(), deviation / mean));
    let density = Shared(Arc::new(every));
    let mut scene = scene.clone();
    scene.sampler = Arc::new(density.clone());
    Ok(Ok(Entrant { strategy: strategy.clone(), scene, density }))
}

impl<'a> Run<'a> {
    fn prepare(
        scene: &Scene,
        path: &Path,
        overrides: &[String],
        settings: &'a Settings,
        samples: Vec<u32>,
        tell: &mut dyn FnMut(&str),
    ) -> Result<Self, BenchError> {
        scene.source.prepare()?;
        let source = scene.source.spectrum().clone();
        let channels: Arc<[Channel]> = match &settings.response {
            Some(response) if response.iter().any(|c| c.response.len() != scene.grid.count) => {
                return Err(BenchError::Settings("response: a channel is not given on the grid of the scene"));
            }
            Some(response) => response.clone().into(),
            None => scene.channels.clone(),
        };
        let system = SystemResponse { grid: scene.grid, source, channels };
        let exact = exact(&system);
        let seen: Vec<usize> = (0..exact.len()).filter(|c| exact[*c] != 0.0).collect();
        if seen.is_empty() {
            return Err(BenchError::Dark);
        }
        let names = system.channels.iter().map(|c| c.name.clone()).collect();
        let first_seed = settings.seed.unwrap_or(scene.render.seed);
        let said = SceneDefaults::by(scene, overrides)?;
        let wanted = if settings.strategies.is_empty() { all() } else { settings.strategies.clone() };
        let (mut entrants, mut left_out) = (Vec::new(), Vec::new());
        for strategy in &wanted {
            if strategy.is_every_factor() {
                match every_factor(strategy, scene, &system, settings, tell)? {
                    Ok(entrant) => entrants.push(entrant),
                    // Skip silently: the user did not name it, and most scenes have a lens.
                    Err(_) if settings.strategies.is_empty() => {}
                    Err(reason) => left_out.push(LeftOut { strategy: strategy.label(), reason: reason.to_string() }),
                }
                continue;
            }
            let (strategy, replacement) = resolve(strategy, &said, scene, &system);
            let overrides: Vec<String> = overrides.iter().cloned().chain(replacement).collect();
            let mut scene = match crate::scene::load(path, &overrides) {
                Ok(scene) => scene,
                // Report it and continue: the user did not name this strategy.
                Err(faults) if settings.strategies.is_empty() => {
                    left_out.push(LeftOut { strategy: strategy.label(), reason: faults.to_string() });
                    continue;
                }
                Err(faults) => return Err(faults.into()),
            };
            match scene.sampler.prepare(&system) {
                Ok(density) => {
                    let density = Shared(density.into());
                    scene.sampler = Arc::new(density.clone());
                    entrants.push(Entrant { strategy, scene, density });
                }
                Err(reason) => left_out.push(LeftOut { strategy: strategy.label(), reason: reason.to_string() }),
            }
        }
        if entrants.is_empty() {
            let why: Vec<String> = left_out.iter().map(|l| format!("{}: {}", l.strategy, l.reason)).collect();
            return Err(BenchError::NoneLeft(why.join("; ")));
        }
        Ok(Self { settings, samples, system, seen, names, first_seed, entrants, left_out })
    }

    /// First seed of the `at`-th number of samples. No two numbers share a seed, so that their errors are independent.
    fn seed(&self, at: usize) -> u64 {
        self.first_seed.wrapping_add((at as u64 + 1).wrapping_mul(SEED_STRIDE))
    }

    fn integral(&self, entrant: &Entrant, kind: NumberKind) -> Series {
        let xyz = colors::xyz_channels(&self.names);
        let draws = |(at, samples): (usize, &u32)| {
            let seeds = self.settings.integral_seeds;
            Draws { kind, samples: *samples, seeds, first_seed: self.seed(at) }
        };
        let one = |draws| measure(&self.system, &entrant.density, &self.seen, xyz, draws, self.settings.isa);
        let measured: Vec<Measured> = self.samples.iter().enumerate().map(draws).map(one).collect();
        self.series(entrant, Measure::Integral, kind, &self.seen, &measured, 1.0)
    }

    /// Renders the scene with all strategies, and the reference that they are compared with.
    fn scene(
        &mut self,
        kind: NumberKind,
        series: &mut Vec<Series>,
        tell: &mut dyn FnMut(&str),
    ) -> Result<Reference, BenchError> {
        let Settings { threads, isa, seeds, .. } = *self.settings;
        let most = self.samples[self.samples.len() - 1];
        // The reference uses the first strategy: the default one if all are compared, else the first requested one.
        let label = self.entrants[0].strategy.label();
        let many = most.saturating_mul(2);
        tell(&format!("reference: {RENDERS} renders of {many} samples per pixel with {label}"));
        let (first_seed, scene) = (self.first_seed, &mut self.entrants[0].scene);
        let of_reference = (0..u64::from(RENDERS)).map(|render| first_seed.wrapping_add(render));
        let (frames, _): (Vec<_>, Vec<_>) =
            renders(scene, &label, many, of_reference, threads, isa)?.into_iter().unzip();
        let truth = Truth::of(&frames);
        let seen = truth.seen();
        if seen.is_empty() {
            return Err(BenchError::Dark);
        }
        let xyz = colors::xyz_channels(&self.names)
            .map(|c| (c, c.map(|c| self.system.source.seen_by(&self.system.channels[c].response))));
        let pixels = self.entrants[0].scene.imager.size().pixels() as f64;
        let mut all = Vec::new();
        for entrant in 0..self.entrants.len() {
            let label = self.entrants[entrant].strategy.label();
            tell(&format!("scene, {label}"));
            let mut measured = Vec::new();
            for (at, samples) in self.samples.clone().iter().enumerate() {
                let first_seed = self.seed(at);
                let scene = &mut self.entrants[entrant].scene;
                let of_seeds = (0..seeds as u64).map(|seed| first_seed.wrapping_add(seed));
                let (frames, times): (Vec<_>, Vec<f64>) =
                    renders(scene, &label, *samples, of_seeds, threads, isa)?.into_iter().unzip();
                let seconds = times.into_iter().fold(f64::INFINITY, f64::min);
                measured.push(Measured { seconds, ..truth.compare(&frames, &seen, xyz) });
            }
            all.push(self.series(&self.entrants[entrant], Measure::Scene, kind, &seen, &measured, pixels));
        }
        related(series, all.into_iter());
        Ok(Reference { strategy: label, renders: RENDERS, samples: many, error: truth.error(&seen) })
    }

    /// Builds the series of one strategy from its measurements. Each of `pixels` pixels receives all samples.
    fn series(
        &self,
        entrant: &Entrant,
        measure: Measure,
        numbers: NumberKind,
        seen: &[usize],
        measured: &[Measured],
        pixels: f64,
    ) -> Series {
        let squared: Vec<Vec<f64>> = measured.iter().map(|m| m.squared.clone()).collect();
        let fitted = fit(&self.samples, &squared);
        let most = f64::from(self.samples[self.samples.len() - 1]);
        let seconds_a_sample = measured[measured.len() - 1].seconds / (most * pixels);
        let point = |at: usize| Point {
            samples: self.samples[at],
            error: fitted.errors[at],
            seconds: seconds_a_sample * f64::from(self.samples[at]) * pixels,
            bias: seen.iter().enumerate().map(|(i, c)| bias(&self.names[*c], &measured[at], i)).collect(),
            ciede2000: measured[at].ciede2000,
            by_seed: measured[at]
                .squared
                .iter()
                .enumerate()
                .map(|(seed, squared)| OfSeed {
                    seed: self.seed(at).wrapping_add(seed as u64),
                    // Clamp at 0: subtracting the noise of the reference may leave a negative square.
                    error: squared.max(0.0).sqrt(),
                    relative: measured[at].relative.iter().map(|of_channel| of_channel[seed]).collect(),
                })
                .collect(),
        };
        Series {
            strategy: entrant.strategy.label(),
            measure,
            numbers,
            seeds: squared[0].len(),
            slope: fitted.slope,
            ns_a_sample: 1e9 * seconds_a_sample,
            ratio_at_equal_samples: None,
            ratio_at_equal_time: None,
            points: (0..measured.len()).map(point).collect(),
        }
    }
}

fn bias(channel: &str, measured: &Measured, at: usize) -> ChannelBias {
    let (relative, variance) = mean_and_variance_of_mean(&measured.relative[at]);
    let standard_errors = in_standard_errors(relative, variance + measured.truth_variance[at]);
    ChannelBias { channel: channel.to_owned(), relative, standard_errors }
}

/// Computes the ratios of each series to the first one, and appends the series to `to`.
fn related(to: &mut Vec<Series>, series: impl Iterator<Item = Series>) {
    let mut first: Option<(f64, f64)> = None;
    for mut one in series {
        let error = one.points.last().map_or(0.0, |p| p.error.value);
        let (base, base_ns) = *first.get_or_insert((error, one.ns_a_sample));
        if base > crate::statistics::ROUNDING {
            let ratio = error / base;
            one.ratio_at_equal_samples = Some(ratio);
            // Extrapolate: in the time of the first strategy this one draws base_ns / ns times as many samples.
            one.ratio_at_equal_time = one
                .slope
                .map(|slope| ratio * libm::pow(base_ns / one.ns_a_sample, slope.value))
                .filter(|r| r.is_finite());
        }
        to.push(one);
    }
}
