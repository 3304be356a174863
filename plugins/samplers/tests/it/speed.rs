//! Measurement of draws per second on one thread; run `cargo test --release -- --ignored --nocapture speed` to print it.

use crate::world::{light, mixed, strategies, system, xyz};
use spectra_core::isa::Isa;
use spectra_core::numbers::Numbers;
use spectra_spectrum::TruncatedGaussian;
use std::time::Instant;

const BATCH: usize = 4096;

/// Returns the best of many runs, in draws per second, because other work on the machine can only slow a run down.
fn best(mut run: impl FnMut()) -> f64 {
    // A run is short enough to fit into one time slice of the scheduler on a busy machine.
    const BATCHES: u32 = 8;
    let once = |_| {
        let start = Instant::now();
        (0..BATCHES).for_each(|_| run());
        f64::from(BATCHES) * BATCH as f64 / start.elapsed().as_secs_f64()
    };
    (0..1000).map(once).fold(0.0, f64::max)
}

#[test]
#[ignore = "a measurement"]
fn speed() {
    let isa = Isa::detect();
    let mut u = vec![0.0; BATCH];
    let (mut nm, mut line, mut weight) = (vec![0.0; BATCH], vec![0; BATCH], vec![1.0; BATCH]);
    println!("million a second, {}", isa.name());
    for (name, numbers) in [("Sobol", Numbers::sobol(1)), ("random", Numbers::random(1))] {
        let mut at = 0;
        let numbers_alone = best(|| {
            numbers.fill(isa, 0, at, 0, &mut u);
            at += BATCH as u64;
        });
        println!("{:8.1} {name} numbers alone", numbers_alone / 1e6);
    }
    let numbers = Numbers::sobol(1);
    numbers.fill(isa, 0, 0, 0, &mut u);
    for (center, sigma) in [(550.0, 60.0), (900.0, 150.0)] {
        let gaussian = TruncatedGaussian::new(center, sigma, 350.0, 830.0).expect("in range");
        let bare = best(|| {
            gaussian.draw(&u, &mut nm, isa);
            std::hint::black_box(&nm);
        });
        println!("{:8.1} truncated Gaussian {center}, {sigma} without floor and weights", bare / 1e6);
    }
    for (light, source) in [("D65", light("D65")), ("FL11 and mercury", mixed())] {
        let system = system(source, xyz());
        for (name, sampler) in strategies() {
            let Ok(density) = sampler.prepare(&system) else { continue };
            let mut at = 0;
            numbers.fill(isa, 0, 0, 0, &mut u);
            let alone = best(|| {
                weight.fill(1.0);
                density.draw(&u, &mut nm, &mut line, &mut weight, isa);
                std::hint::black_box((&nm, &weight));
            });
            let with_numbers = best(|| {
                numbers.fill(isa, 0, at, 0, &mut u);
                at += BATCH as u64;
                weight.fill(1.0);
                density.draw(&u, &mut nm, &mut line, &mut weight, isa);
                std::hint::black_box((&nm, &weight));
            });
            println!("{:8.1} {name}, {light}; {:.1} with the numbers", alone / 1e6, with_numbers / 1e6);
        }
    }
}
