//! Tests of `hero`: groups of samples that share one rotated number.

use crate::world::{draw, estimate, exact, imagers, light, lights, system, xyz};
use spectra_core::isa::Isa;
use spectra_core::numbers::Numbers;
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};
use spectra_plugin_samplers::{Hero, SourceTimesResponse, Uniform};
use statrs::distribution::{ChiSquared, ContinuousCDF};

fn hero(group: u32, density: impl WavelengthSampler + 'static) -> Hero {
    Hero::new(group, Box::new(density)).expect("in range")
}

/// Returns numbers as the renderer draws them for this density.
fn numbers(density: &dyn WavelengthDensity, numbers: &Numbers, many: usize) -> Vec<f64> {
    let mut u = vec![0.0; many];
    numbers.fill_rotated(Isa::detect(), 3, 0, density.group(), 0, &mut u);
    u
}

#[test]
fn the_group_reaches_the_renderer() {
    let system = system(light("D65"), xyz());
    assert_eq!(hero(8, Uniform).prepare(&system).expect("can be drawn").group(), 8);
    assert_eq!(Uniform.prepare(&system).expect("can be drawn").group(), 1);
    assert!(Hero::new(1, Box::new(Uniform)).is_none() && Hero::new(1025, Box::new(Uniform)).is_none());
}

/// Each member of a group follows the density of the strategy, by chi-square over 64 bins of equal probability. (Members of one group
/// are not independent, so each is tested separately.)
#[test]
fn every_member_of_a_group_follows_the_density() {
    let system = system(light("D65"), xyz());
    let density = hero(4, SourceTimesResponse).prepare(&system).expect("can be drawn");
    let u = numbers(density.as_ref(), &Numbers::random(5), 400_000);
    let draws = draw(density.as_ref(), &u);
    // Edges of bins with equal probability, by the midpoint rule over the stated density.
    let (cells, step) = (480 * 64, 1.0 / 64.0);
    let mut edges = Vec::new();
    let mut sum = 0.0;
    for i in 0..cells {
        sum += density.density_per_nm(350.0 + (f64::from(i) + 0.5) * step) * step;
        while edges.len() < 63 && sum >= (edges.len() + 1) as f64 / 64.0 {
            edges.push(350.0 + f64::from(i + 1) * step);
        }
    }
    for member in 0..4 {
        let mut counts = [0.0; 64];
        let of_member = draws.wavelength_nm.iter().skip(member).step_by(4);
        let n = 100_000.0;
        of_member.for_each(|nm| counts[edges.partition_point(|e| e <= nm)] += 1.0);
        // The edges lie on a grid, so the exact probability of a bin is the density integrated between its edges.
        let mut chi2 = 0.0;
        for (i, count) in counts.iter().enumerate() {
            let from = if i == 0 { 350.0 } else { edges[i - 1] };
            let to = edges.get(i).copied().unwrap_or(830.0);
            let parts = ((to - from) / step).round() as i32;
            let mass: f64 = (0..parts).map(|k| density.density_per_nm(from + (f64::from(k) + 0.5) * step) * step).sum();
            chi2 += (count - n * mass) * (count - n * mass) / (n * mass);
        }
        let p = ChiSquared::new(63.0).expect("positive").sf(chi2);
        println!("member {member}: p {p:.3}");
        assert!(p > 1e-3, "member {member}: {p:e}");
    }
}

/// Estimates are unbiased within three standard errors over 1 000 seeds, for a group that divides the number of samples and one that does
/// not.
#[test]
fn groups_are_unbiased() {
    for (light, source) in lights() {
        for (imager, channels) in imagers() {
            let system = system(source.clone(), channels);
            let want = exact(&system);
            for group in [4, 7] {
                let density = hero(group, SourceTimesResponse).prepare(&system).expect("can be drawn");
                let mut sums = vec![[0.0; 2]; want.len()];
                for seed in 0..1000 {
                    let u = numbers(density.as_ref(), &Numbers::random(seed), 16);
                    let got = estimate(&system, &draw(density.as_ref(), &u));
                    for (sum, (got, want)) in sums.iter_mut().zip(got.iter().zip(&want)) {
                        let off = got / want - 1.0;
                        sum[0] += off;
                        sum[1] += off * off;
                    }
                }
                for [sum, squares] in sums {
                    let (mean, n) = (sum / 1000.0, 1000.0);
                    let error = ((squares / n - mean * mean).max(0.0) / (n - 1.0)).sqrt();
                    assert!(mean.abs() <= 3.0 * error + 1e-12, "{light}, {imager}, {group}: {mean:e} +- {error:e}");
                }
            }
        }
    }
}

/// The purpose of groups: with independent numbers, 64 samples in groups of 16 scatter less than 64 independent ones.
#[test]
fn groups_take_noise_from_independent_numbers() {
    let system = system(light("D65"), xyz());
    let want = exact(&system);
    let error = |sampler: &dyn WavelengthSampler| {
        let density = sampler.prepare(&system).expect("can be drawn");
        let squared = |seed| {
            let u = numbers(density.as_ref(), &Numbers::random(seed), 64);
            let got = estimate(&system, &draw(density.as_ref(), &u));
            got.iter().zip(&want).map(|(g, w)| (g / w - 1.0) * (g / w - 1.0)).sum::<f64>()
        };
        (0..300).map(squared).sum::<f64>().sqrt()
    };
    let (alone, grouped) = (error(&SourceTimesResponse), error(&hero(16, SourceTimesResponse)));
    println!("independent {alone:.4}, in groups of 16 {grouped:.4}: {:.2} times", alone / grouped);
    assert!(grouped < 0.5 * alone, "{grouped} {alone}");
}
