//! The diffusion filter of the example plugin: from the source and from the imager it gives the same picture, lit card and halo.

/// The plugin itself, with its tests.
#[path = "../plugins/examples/diffusion-filter/src/lib.rs"]
mod diffusion_filter;

use spectra_core::Isa;
use spectra_plugins as _;
use spectra_render::{Control, Renderer, Threads};
use std::path::Path;

const SEEDS: u64 = 16;

/// Illuminance of each pixel, lx, of one seed; and the same bits with other batches.
fn render(direction: &str, count: &str, seed: u64) -> Vec<f64> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("plugins/examples/diffusion-filter/card.yaml");
    let frames = [256, 100].map(|batch| {
        let overrides = [
            format!("render.direction={direction}"),
            format!("render.{count}"),
            format!("render.seed={seed}"),
            format!("render.batch={batch}"),
        ];
        let scene = spectra_scene::load(&path, &overrides).unwrap_or_else(|faults| panic!("{faults}"));
        let renderer = Renderer::new(scene, Isa::detect()).expect("the scene can be rendered");
        renderer.run(&Threads(2), &Control::new()).expect("rendered").exposure
    });
    let y = |k: usize| &frames[k].channel("Y").expect("an XYZ imager").values;
    assert_eq!(y(0), y(1), "batches of another size give other bits");
    y(0).iter().map(|y| f64::from(*y)).collect()
}

/// Mean and standard error of each pixel.
fn estimate(direction: &str, count: &str) -> Vec<(f64, f64)> {
    let runs: Vec<Vec<f64>> = (1..=SEEDS).map(|seed| render(direction, count, seed)).collect();
    let n = SEEDS as f64;
    let of = |pixel: usize| {
        let mean = runs.iter().map(|run| run[pixel]).sum::<f64>() / n;
        let variance = runs.iter().map(|run| (run[pixel] - mean) * (run[pixel] - mean)).sum::<f64>() / (n - 1.0);
        (mean, (variance / n).sqrt())
    };
    (0..runs[0].len()).map(of).collect()
}

/// The 150 pixels' differences in standard errors have a mean square of 30/28 (Student's t of 30 degrees of freedom; good to 0.13),
/// none is beyond what t exceeds in one of 370 such pictures, and the sums over card and halo agree within 3 standard errors.
#[test]
fn both_directions_are_equal() {
    let (backward, forward) = (estimate("backward", "samples=1024"), estimate("forward", "rays=2000000"));
    let middle = backward.iter().map(|b| b.0).fold(0.0, f64::max);
    let (mut squares, mut most) = (0.0, 0.0_f64);
    // Difference, its variance, and light: card, halo.
    let mut parts = [[0.0; 3]; 2];
    for ((b, eb), (f, ef)) in backward.iter().zip(&forward) {
        let variance = eb * eb + ef * ef;
        squares += (f - b) * (f - b) / variance;
        most = most.max((f - b).abs() / variance.sqrt());
        let part = &mut parts[usize::from(*b < 0.1 * middle)];
        for (sum, add) in part.iter_mut().zip([f - b, variance, *b]) {
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
    assert!(parts[1][2] > 0.02 * parts[0][2], "no halo");
    assert!((0.7..1.45).contains(&mean_square) && most < 5.0);
}
