//! Tests of samples against the stated density: chi-square, and the Kolmogorov-Smirnov test on the continuum.

use crate::world::{CONTINUUM, Draws, draw, imagers, lights, may_refuse, strategies, system};
use spectra_core::isa::Isa;
use spectra_core::numbers::Numbers;
use spectra_core::spectral::SystemResponse;
use spectra_core::stage::WavelengthDensity;
use statrs::distribution::{ChiSquared, ContinuousCDF};

const SAMPLES: usize = 100_000;
/// Number of steps per nanometer in which a stated density is integrated.
const STEPS: usize = 64;

/// Cumulative distribution of the continuum on a fine grid, by the midpoint rule over the stated density.
struct Cumulative {
    start_nm: f64,
    at: Vec<f64>,
}

impl Cumulative {
    fn of(system: &SystemResponse, density: &dyn WavelengthDensity) -> Self {
        let start_nm = system.grid.start_nm;
        let cells = (system.grid.end_nm() - start_nm) as usize * STEPS;
        let mut at = vec![0.0];
        let mut sum = 0.0;
        for i in 0..cells {
            sum += density.density_per_nm(start_nm + (i as f64 + 0.5) / STEPS as f64) / STEPS as f64;
            at.push(sum);
        }
        Self { start_nm, at }
    }

    fn total(&self) -> f64 {
        self.at[self.at.len() - 1]
    }

    fn at(&self, nm: f64) -> f64 {
        let p = (nm - self.start_nm) * STEPS as f64;
        let i = (p as usize).min(self.at.len() - 2);
        self.at[i] + (self.at[i + 1] - self.at[i]) * (p - i as f64)
    }
}

/// Returns the p-value of the draws by the chi-square test, with 64 bins of equal probability for the continuum and one for each line.
fn chi_square(draws: &Draws, cumulative: &Cumulative, lines: &[f64]) -> f64 {
    const BINS: usize = 64;
    let n = draws.line.len() as f64;
    let mut counts = vec![0.0; BINS + lines.len()];
    for (nm, line) in draws.wavelength_nm.iter().zip(&draws.line) {
        let bin = match *line {
            CONTINUUM => ((cumulative.at(*nm) / cumulative.total() * BINS as f64) as usize).min(BINS - 1),
            line => BINS + line as usize,
        };
        counts[bin] += 1.0;
    }
    let of_bin = cumulative.total() / BINS as f64;
    let expected = std::iter::repeat_n(of_bin, BINS).chain(lines.iter().copied());
    let (mut chi2, mut bins) = (0.0, 0.0);
    for (count, probability) in counts.iter().zip(expected) {
        if probability > 0.0 {
            chi2 += (count - n * probability) * (count - n * probability) / (n * probability);
            bins += 1.0;
        } else {
            assert_eq!(*count, 0.0, "drawn though its probability is 0");
        }
    }
    if bins < 2.0 { 1.0 } else { ChiSquared::new(bins - 1.0).expect("positive").sf(chi2) }
}

/// Returns the p-value by the limiting distribution of the greatest distance (A. Kolmogorov, 1933), with M. A. Stephens's correction for
/// finite numbers of draws (Journal of the Royal Statistical Society B 32, 1970).
fn kolmogorov_smirnov(draws: &Draws, cumulative: &Cumulative) -> f64 {
    let of_continuum = draws.wavelength_nm.iter().zip(&draws.line).filter(|d| *d.1 == CONTINUUM);
    let mut shares: Vec<f64> = of_continuum.map(|d| cumulative.at(*d.0) / cumulative.total()).collect();
    if shares.is_empty() {
        return 1.0;
    }
    shares.sort_by(f64::total_cmp);
    let n = shares.len() as f64;
    let off = |(i, share): (usize, &f64)| f64::max(share - i as f64 / n, (i + 1) as f64 / n - share);
    let distance = shares.iter().enumerate().map(off).fold(0.0, f64::max);
    let x = distance * (n.sqrt() + 0.12 + 0.11 / n.sqrt());
    let term = |k: i32| {
        let sign = if k % 2 == 1 { 1.0 } else { -1.0 };
        2.0 * sign * libm::exp(-2.0 * f64::from(k * k) * x * x)
    };
    if x < 0.2 { 1.0 } else { (1..=100).map(term).sum::<f64>().clamp(0.0, 1.0) }
}

#[test]
fn samples_follow_the_stated_density() {
    let mut least: f64 = 1.0;
    for (light, source) in lights() {
        for (imager, channels) in imagers() {
            let system = system(source.clone(), channels);
            for (name, sampler) in strategies() {
                let Ok(density) = sampler.prepare(&system) else {
                    assert!(may_refuse(name), "{name}, {light}, {imager}");
                    continue;
                };
                let mut u = vec![0.0; SAMPLES];
                Numbers::random(11).fill(Isa::detect(), 0, 0, 0, &mut u);
                let draws = draw(density.as_ref(), &u);
                let lines: Vec<f64> = (0..system.source.lines.len()).map(|i| density.line_probability(i)).collect();
                let cumulative = Cumulative::of(&system, density.as_ref());
                let total = cumulative.total() + lines.iter().sum::<f64>();
                assert!((total - 1.0).abs() < 2e-4, "{name}, {light}, {imager}: {total}");
                let chi2 = chi_square(&draws, &cumulative, &lines);
                let ks = kolmogorov_smirnov(&draws, &cumulative);
                assert!(chi2 > 1e-3 && ks > 1e-3, "{name}, {light}, {imager}: p {chi2:e} and {ks:e}");
                least = least.min(chi2).min(ks);
            }
        }
    }
    println!("smallest p {least:.4}");
}

/// Every weight is one over the probability (or density) that the strategy states for the line (or wavelength) drawn.
#[test]
fn weights_are_one_over_the_stated_density() {
    for (light, source) in lights() {
        for (imager, channels) in imagers() {
            let system = system(source.clone(), channels);
            for (name, sampler) in strategies() {
                let Ok(density) = sampler.prepare(&system) else { continue };
                if ["gaussian-terms, term then wavelength", "gaussian-terms, one term"].contains(&name) {
                    continue; // weights are signed: only their mean at a wavelength is one over the density
                }
                let mut u = vec![0.0; 4096];
                Numbers::sobol(3).fill(Isa::detect(), 0, 0, 0, &mut u);
                let draws = draw(density.as_ref(), &u);
                for i in 0..u.len() {
                    let probability = match draws.line[i] {
                        CONTINUUM => density.density_per_nm(draws.wavelength_nm[i]),
                        line => density.line_probability(line as usize),
                    };
                    let product = probability * draws.weight[i];
                    // A draw that is within a rounding error of a quantile's edge may find the density on the other side.
                    let near_edge = 1e-9 * draws.weight[i].max(1.0);
                    let beside = [-near_edge, near_edge]
                        .map(|d| density.density_per_nm(draws.wavelength_nm[i] + d) * draws.weight[i]);
                    let good = |p: f64| (p - 1.0).abs() < 1e-9;
                    assert!(good(product) || beside.into_iter().any(good), "{name}, {light}, {imager}: {product}");
                }
            }
        }
    }
}
