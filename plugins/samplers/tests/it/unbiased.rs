//! Test of estimates against quadrature, over 1 000 seeds.

use crate::world::{draw, estimate, exact, imagers, lights, may_refuse, sobol, strategies, system};

const SEEDS: u64 = 1000;
const SAMPLES: usize = 64;

/// Estimates agree with quadrature within three standard errors of the mean. Each seed has 64 Sobol numbers, whose small scatter reveals
/// small biases.
#[test]
fn estimates_are_unbiased() {
    let mut worst: f64 = 0.0;
    for (light, source) in lights() {
        for (imager, channels) in imagers() {
            let system = system(source.clone(), channels);
            let want = exact(&system);
            for (name, sampler) in strategies() {
                let Ok(density) = sampler.prepare(&system) else {
                    assert!(may_refuse(name), "{name}, {light}, {imager}");
                    continue;
                };
                let mut sums = vec![[0.0; 2]; want.len()];
                for seed in 0..SEEDS {
                    let u = sobol(seed, SAMPLES);
                    let got = estimate(&system, &draw(density.as_ref(), &u));
                    for (sum, (got, want)) in sums.iter_mut().zip(got.iter().zip(&want)) {
                        let off = got / want - 1.0;
                        sum[0] += off;
                        sum[1] += off * off;
                    }
                }
                for (channel, [sum, squares]) in system.channels.iter().zip(sums) {
                    let n = SEEDS as f64;
                    let mean = sum / n;
                    let error = ((squares / n - mean * mean).max(0.0) / (n - 1.0)).sqrt();
                    let z = mean.abs() / error.max(1e-13);
                    worst = worst.max(if error > 1e-12 { z } else { 0.0 });
                    assert!(
                        mean.abs() <= 3.0 * error + 1e-12,
                        "{name}, {light}, {imager} {}: {mean:e} +- {error:e}",
                        channel.name
                    );
                }
            }
        }
    }
    println!("largest {worst:.2} standard errors");
}
