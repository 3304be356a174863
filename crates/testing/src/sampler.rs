//! The laws that every wavelength sampler must obey.

use crate::system::systems;
use crate::test_numbers::{TestNumbers, mean_and_error};
use spectra_core::Isa;
use spectra_core::batch::CONTINUUM;
use spectra_core::math::{exp, sin};
use spectra_core::spectral::{BAND, SystemResponse};
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};

/// The laws of wavelength samplers, with the facts about a sampler that are needed to check them.
///
/// The laws are checked on those [`systems`] that the sampler accepts, which must be at least one. It must refuse the others with a
/// message.
///
/// - The integral of the density over the band and the probabilities of the lines add up to 1, and none is negative.
/// - The density is positive wherever the system has light that a channel records; wavelengths that are never drawn would be
///   missing in the picture.
/// - Samples follow the density: chi-square over 40 bins and the lines is within 6 standard deviations.
/// - Weights are one over the density.
/// - A test integral is right within 5 standard errors.
/// - The result does not depend on how numbers are split into batches, nor on the instruction set.
#[derive(Clone, Copy, Debug)]
pub struct SamplerLaws {
    /// Whether each weight is one over the density; false for a signed mixture, whose samples also carry a sign.
    pub weight_is_inverse_density: bool,
    /// Whether samples follow the density, with one number per sample. False for a sampler that follows one term of the source.
    pub follows_density: bool,
    /// Tolerance for the integral of the density, at least 1e-5.
    pub tolerance: f64,
    /// Number of samples for each system.
    pub samples: usize,
}

impl Default for SamplerLaws {
    /// Returns the laws of a sampler whose density can be evaluated.
    fn default() -> Self {
        Self { weight_is_inverse_density: true, follows_density: true, tolerance: 1e-6, samples: 1 << 15 }
    }
}

/// Drawn wavelengths with their lines and weights.
#[derive(Clone, Debug, PartialEq)]
struct Drawn {
    wavelength_nm: Vec<f64>,
    line: Vec<u32>,
    weight: Vec<f64>,
}

impl SamplerLaws {
    /// Checks all laws on a sampler.
    ///
    /// # Panics
    /// At the first case that breaks a law; the message describes it.
    pub fn hold(&self, sampler: &dyn WavelengthSampler) {
        let mut accepted = 0;
        for (name, system) in systems() {
            match sampler.prepare(&system) {
                Ok(density) => {
                    accepted += 1;
                    self.hold_for(name, &system, &*density);
                }
                Err(text) => assert!(!text.message.trim().is_empty(), "{name}: refused without a reason"),
            }
        }
        assert!(accepted > 0, "it refuses every system");
    }

    fn hold_for(&self, name: &str, system: &SystemResponse, density: &dyn WavelengthDensity) {
        let lines = system.source.lines.len();
        let of_lines: Vec<f64> = (0..lines).map(|line| density.line_probability(line)).collect();
        assert!(of_lines.iter().all(|p| (0.0..=1.0).contains(p)), "{name}: probabilities of lines are {of_lines:?}");
        let (whole, least) = integral(density, BAND.start_nm, BAND.end_nm(), 48_000);
        assert!(least >= 0.0, "{name}: the density falls to {least} per nm");
        let sum = whole + of_lines.iter().sum::<f64>();
        assert!((sum - 1.0).abs() < self.tolerance.max(1e-5), "{name}: density and lines add up to {sum}, not to 1");
        let seen = system.summed_response();
        for (i, nm) in BAND.wavelengths_nm().enumerate() {
            // A point of the grid may be the very end of a channel's response, so only interior points are checked.
            let inside = i > 0 && i + 1 < BAND.count && seen[i - 1] > 1e-9 && seen[i] > 1e-9 && seen[i + 1] > 1e-9;
            let p = density.density_per_nm(nm);
            assert!(
                p > 0.0 || !inside || system.source.continuum[i] == 0.0,
                "{name}: {nm} nm is never drawn, though there is light that a channel records"
            );
        }
        for (line, p) in system.source.lines.iter().zip(&of_lines) {
            let visible = BAND.interpolate(&seen, line.wavelength_nm) > 1e-9;
            assert!(*p > 0.0 || !visible, "{name}: the line of {} nm is never drawn", line.wavelength_nm);
        }
        assert!(density.group() >= 1, "{name}: groups of {}", density.group());
        let u = TestNumbers::new(31).column(self.samples, 0);
        let drawn = draw(density, &u, 256, Isa::Baseline);
        for (batch, isa) in
            [1, 64, 1000].map(|b| (b, Isa::Baseline)).into_iter().chain(Isa::available().into_iter().map(|i| (256, i)))
        {
            let same = draw(density, &u, batch, isa) == drawn;
            assert!(same, "{name}: different samples in batches of {batch} on {}", isa.name());
        }
        self.check_samples(name, system, density, &drawn);
        if self.follows_density {
            self.check_distribution(name, density, &of_lines, &drawn);
        }
        check_integral(name, system, &drawn);
        // The ends of the range of numbers.
        let ends = draw(density, &[0.0, 1.0 - 0.5 * f64::EPSILON], 2, Isa::detect());
        self.check_samples(name, system, density, &ends);
    }

    fn check_samples(&self, name: &str, system: &SystemResponse, density: &dyn WavelengthDensity, drawn: &Drawn) {
        for i in 0..drawn.line.len() {
            let (nm, line, weight) = (drawn.wavelength_nm[i], drawn.line[i], drawn.weight[i]);
            assert!(weight.is_finite(), "{name}: a sample at {nm} nm weighs {weight}");
            let p = if line == CONTINUUM {
                assert!(BAND.contains(nm), "{name}: {nm} nm is drawn, outside the band");
                density.density_per_nm(nm)
            } else {
                let Some(of) = system.source.lines.get(line as usize) else { panic!("{name}: no line {line} exists") };
                assert!(
                    nm == of.wavelength_nm,
                    "{name}: line {line} is drawn at {nm} nm, but lies at {} nm",
                    of.wavelength_nm
                );
                density.line_probability(line as usize)
            };
            if self.weight_is_inverse_density {
                // Next to an edge of the density, rounding decides on which side a sample lies.
                let near = [-1e-7, 1e-7].map(|d| density.density_per_nm(nm + d));
                let close = |p: f64| (weight * p - 1.0).abs() < 1e-9;
                let good = close(p) || line == CONTINUUM && near.into_iter().any(|p| (weight * p - 1.0).abs() < 1e-6);
                assert!(good, "{name}: a sample at {nm} nm weighs {weight}, but one over its density is {}", 1.0 / p);
            }
        }
    }

    fn check_distribution(&self, name: &str, density: &dyn WavelengthDensity, of_lines: &[f64], drawn: &Drawn) {
        const BINS: usize = 40;
        let many = drawn.line.len() as f64;
        let width = (BAND.end_nm() - BAND.start_nm) / BINS as f64;
        let mut found = vec![0.0; BINS + of_lines.len()];
        for (line, nm) in drawn.line.iter().zip(&drawn.wavelength_nm) {
            let bin = (((nm - BAND.start_nm) / width) as usize).min(BINS - 1);
            found[if *line == CONTINUUM { bin } else { BINS + *line as usize }] += 1.0;
        }
        let start = |bin: usize| BAND.start_nm + width * bin as f64;
        let mut want: Vec<f64> =
            (0..BINS).map(|bin| many * integral(density, start(bin), start(bin + 1), 1200).0).collect();
        want.extend(of_lines.iter().map(|p| many * p));
        // Bins with few expected samples are merged with their neighbors.
        let (mut chi2, mut cells, mut few) = (0.0, 0, (0.0, 0.0));
        for (found, want) in found.into_iter().zip(want) {
            few = (few.0 + found, few.1 + want);
            if few.1 >= 20.0 {
                chi2 += (few.0 - few.1) * (few.0 - few.1) / few.1;
                cells += 1;
                few = (0.0, 0.0);
            }
        }
        assert!(few.0 <= few.1 + 6.0 * (few.1 + 1.0).sqrt(), "{name}: {} samples where {} are expected", few.0, few.1);
        // Chi-square with k degrees of freedom has mean k and variance 2 k; the tail beyond 6 standard deviations is about 1e-6.
        let degrees = f64::from(cells.max(2) - 1);
        let deviations = (chi2 - degrees) / (2.0 * degrees).sqrt();
        assert!(
            deviations < 6.0,
            "{name}: samples do not follow the density: chi-square is {chi2:.1} for {degrees} degrees of freedom"
        );
    }
}

/// Returns the integral of the density by the midpoint rule, and its least value, 1/nm.
fn integral(density: &dyn WavelengthDensity, from_nm: f64, to_nm: f64, steps: u32) -> (f64, f64) {
    let step = (to_nm - from_nm) / f64::from(steps);
    let (mut sum, mut least) = (0.0, f64::INFINITY);
    for i in 0..steps {
        let p = density.density_per_nm(from_nm + step * (f64::from(i) + 0.5));
        sum += p;
        least = if p >= least { least } else { p };
    }
    (sum * step, least)
}

fn draw(density: &dyn WavelengthDensity, u: &[f64], batch: usize, isa: Isa) -> Drawn {
    let many = u.len();
    let mut all = Drawn { wavelength_nm: vec![0.0; many], line: vec![CONTINUUM; many], weight: vec![1.0; many] };
    for first in (0..many).step_by(batch) {
        let part = first..many.min(first + batch);
        let (nm, line) = (&mut all.wavelength_nm[part.clone()], &mut all.line[part.clone()]);
        density.draw(&u[part.clone()], nm, line, &mut all.weight[part], isa);
    }
    all
}

/// Compares a test integral, of light times response times a wave over the band, by samples and by quadrature.
fn check_integral(name: &str, system: &SystemResponse, drawn: &Drawn) {
    let seen = system.summed_response();
    let wave = |nm: f64| 1.0 + 0.5 * sin(nm / 20.0) * exp((nm - 600.0) / 300.0);
    let continuum = |nm: f64| BAND.interpolate(&system.source.continuum, nm) * BAND.interpolate(&seen, nm) * wave(nm);
    let line = |at: usize| {
        let line = system.source.lines[at];
        line.power * BAND.interpolate(&seen, line.wavelength_nm) * wave(line.wavelength_nm)
    };
    let steps = 48_000;
    let step = (BAND.end_nm() - BAND.start_nm) / f64::from(steps);
    let smooth: f64 = (0..steps).map(|i| continuum(BAND.start_nm + step * (f64::from(i) + 0.5))).sum::<f64>() * step;
    let want = smooth + (0..system.source.lines.len()).map(line).sum::<f64>();
    let sample = |i: usize| {
        let of = drawn.line[i];
        drawn.weight[i] * if of == CONTINUUM { continuum(drawn.wavelength_nm[i]) } else { line(of as usize) }
    };
    let values: Vec<f64> = (0..drawn.line.len()).map(sample).collect();
    let (mean, error) = mean_and_error(&values);
    let off = (mean - want).abs();
    assert!(
        off < 5.0 * error + 1e-6 * want,
        "{name}: the test integral is {want:.6}; samples give {mean:.6}, {:.1} standard errors off",
        off / error
    );
}
