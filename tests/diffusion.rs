//! Tests the diffusion filter of the example plugin: card and halo are the same in the picture from the source and from the imager.
//! This is a separate program, because the plugin is registered in it.

/// The code of the plugin itself, with its tests.
#[path = "../plugins/examples/diffusion-filter/src/lib.rs"]
mod diffusion_filter;

#[path = "it/common/mod.rs"]
mod common;

use common::repository;
use common::statistics::{self, Estimate, bits, estimates, over_seeds, pixels, ready, rendered};
use spectra_render::Renderer;

const SEEDS: u64 = 16;

fn card(overrides: &[&str]) -> Renderer {
    ready(statistics::load(&repository("plugins/examples/diffusion-filter/card.yaml"), overrides))
}

/// Returns the illuminance of each pixel, lx.
fn estimate(direction: &str, count: &str) -> Vec<Estimate> {
    estimates(&over_seeds(&card(&[direction, count]), 1..1 + SEEDS, pixels))
}

/// A stage that draws its own random numbers gives the same bits for any batch size.
#[test]
fn batches_of_any_size_have_the_same_bits() {
    for few in [["render.direction=backward", "render.samples=64"], ["render.direction=forward", "render.rays=100000"]]
    {
        let by = |batch| bits(&rendered(&card(&[&few[..], &[batch]].concat())));
        assert!(by("render.batch=256") == by("render.batch=100"), "{few:?}");
    }
}

/// Compares both directions. The differences of the 150 pixels in standard errors have a mean square of 30/28 (Student's t of 30
/// degrees of freedom; accurate to 0.13). None exceeds what t exceeds in one of 370 such pictures, and the sums over card and halo
/// agree within 3 standard errors.
#[test]
fn both_directions_are_equal() {
    let (backward, forward) = (
        estimate("render.direction=backward", "render.samples=1024"),
        estimate("render.direction=forward", "render.rays=2000000"),
    );
    let middle = backward.iter().map(|b| b.mean).fold(0.0, f64::max);
    let (mut squares, mut most) = (0.0, 0.0_f64);
    // Difference, its variance, and light, for card and halo.
    let mut parts = [[0.0; 3]; 2];
    for (backward, forward) in backward.iter().zip(&forward) {
        let (b, f) = (backward.mean, forward.mean);
        let variance = backward.error * backward.error + forward.error * forward.error;
        squares += (f - b) * (f - b) / variance;
        most = most.max((f - b).abs() / variance.sqrt());
        let part = &mut parts[usize::from(b < 0.1 * middle)];
        for (sum, add) in part.iter_mut().zip([f - b, variance, b]) {
            *sum += add;
        }
    }
    let mean_square = squares / backward.len() as f64;
    println!("mean square {mean_square:.3}, at most {most:.2} standard errors");
    for (name, [difference, variance, light]) in ["card", "halo"].into_iter().zip(parts) {
        let errors = difference / variance.sqrt();
        println!(
            "{name}: {:+.5} of the light, {errors:+.2} standard errors of {:.5}",
            difference / light,
            variance.sqrt() / light
        );
        assert!(errors.abs() < 3.0 && light > 0.0, "{name}");
    }
    assert!(parts[1][2] > 0.02 * parts[0][2], "the halo is missing");
    assert!((0.7..1.45).contains(&mean_square) && most < 5.0);
}
