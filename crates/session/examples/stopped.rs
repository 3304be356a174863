//! Measures how far a frame that is stopped early lies from the finished one:
//! `cargo run --release -p spectra-session --example stopped -- SCENE [path=value ...]`.
//!
//! Each of 16 seeds is stopped at a tenth and at a half of the rays of the whole picture. Their mean over blocks of 32 x 32 pixels is
//! compared with the mean of 16 whole pictures with other seeds, in standard errors. Prints the blocks beyond 4, the worst block, the light
//! of the brightest hundredth of the blocks, and, with `noise:`, the noise that the frames state over the noise among the seeds.

use spectra_core::frame::ExposureFrame;
use spectra_plugins as _;
use spectra_render::{RenderOptions, Renderer, Rendering};
use spectra_session::{Control, Threads};

const SEEDS: u64 = 16;
/// Side of a block, pixels.
const BLOCK: usize = 32;

/// Returns the mean of each block of a frame, in its first channel.
fn blocks(frame: &ExposureFrame) -> Vec<f64> {
    let (width, height) = (frame.size.width_px as usize, frame.size.height_px as usize);
    let (across, down) = (width.div_ceil(BLOCK), height.div_ceil(BLOCK));
    let (mut sums, mut counts) = (vec![0.0; across * down], vec![0.0; across * down]);
    for (pixel, value) in frame.channels[0].values.iter().enumerate() {
        let block = pixel / width / BLOCK * across + pixel % width / BLOCK;
        sums[block] += f64::from(*value);
        counts[block] += 1.0;
    }
    sums.iter().zip(counts).map(|(sum, count)| sum / count).collect()
}

/// Returns the mean of a figure over runs, and the variance of that mean.
fn mean(runs: &[Vec<f64>], at: usize) -> (f64, f64) {
    let n = runs.len() as f64;
    let mean = runs.iter().map(|run| run[at]).sum::<f64>() / n;
    (mean, runs.iter().map(|run| (run[at] - mean).powi(2)).sum::<f64>() / (n - 1.0) / n)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (scene, set) = arguments.split_first().ok_or("name a scene")?;
    let threads = Threads(std::thread::available_parallelism()?.get());
    let series = spectra_scene::load_series(scene.as_ref(), set)?;
    let renderer = Renderer::new(series.scene(0)?, &RenderOptions { workers: &threads, ..RenderOptions::default() })?;
    let samples = u64::from(renderer.scene().render.samples);
    let run = |seed: u64, rays: Option<u64>| -> Result<Rendering, Box<dyn std::error::Error>> {
        let own = renderer.reseeded(seed);
        let mut light = own.begin()?;
        let control = rays.map_or_else(Control::new, Control::stopping_after);
        own.advance(&mut light, samples, &threads, &control)?;
        Ok(own.rendering(own.scene(), &light)?)
    };
    let whole: Vec<Rendering> = (0..SEEDS).map(|seed| run(1000 + seed, None)).collect::<Result<_, _>>()?;
    let rays = whole.iter().map(|run| run.rays).sum::<u64>() / SEEDS;
    let wanted: Vec<Vec<f64>> = whole.iter().map(|run| blocks(&run.exposure)).collect();
    println!("{scene}: {rays} rays in {samples} samples");
    for part in [10, 2] {
        let stopped: Vec<Rendering> = (0..SEEDS).map(|seed| run(seed, Some(rays / part))).collect::<Result<_, _>>()?;
        let found: Vec<Vec<f64>> = stopped.iter().map(|run| blocks(&run.exposure)).collect();
        let mut errors: Vec<(f64, f64, f64)> = (0..wanted[0].len())
            .map(|at| {
                let ((a, variance_a), (b, variance_b)) = (mean(&found, at), mean(&wanted, at));
                let error = (variance_a + variance_b).sqrt();
                (if error > 0.0 { (a - b).abs() / error } else { 0.0 }, a, b)
            })
            .collect();
        let dark = found.iter().flatten().filter(|value| **value == 0.0).count();
        let beyond = errors.iter().filter(|(error, ..)| *error > 4.0).count() as f64 / errors.len() as f64;
        let worst = errors.iter().map(|(error, ..)| *error).fold(0.0, f64::max);
        errors.sort_by(|a, b| b.2.total_cmp(&a.2));
        let lamps = &errors[..errors.len().div_ceil(100)];
        let [a, b] = [lamps.iter().map(|l| l.1).sum::<f64>(), lamps.iter().map(|l| l.2).sum::<f64>()];
        println!(
            "  at 1/{part}: {:.2} % of blocks beyond 4 standard errors, worst {worst:.1}, light of the brightest blocks {:+.2} %, {dark} blocks without light",
            100.0 * beyond,
            100.0 * (a / b - 1.0)
        );
        let mut stated: Vec<f64> = stopped.iter().filter_map(|run| run.noise.map(|noise| noise.median)).collect();
        if stated.is_empty() {
            continue;
        }
        stated.sort_by(f64::total_cmp);
        println!(
            "    noise: {:.2} % stated, {:.2} % among the seeds",
            100.0 * stated[stated.len() / 2],
            100.0 * among(&stopped)
        );
    }
    Ok(())
}

/// Returns the noise of a pixel among the seeds relative to the mean, in the median over blocks of 16 x 16 pixels.
fn among(runs: &[Rendering]) -> f64 {
    const SIDE: usize = 16;
    let size = runs[0].exposure.size;
    let (width, across) = (size.width_px as usize, (size.width_px as usize).div_ceil(SIDE));
    let mut sums = vec![(0.0, 0.0, 0.0); across * (size.height_px as usize).div_ceil(SIDE)];
    let n = runs.len() as f64;
    for pixel in 0..size.pixels() {
        let values = || runs.iter().map(|run| f64::from(run.exposure.channels[0].values[pixel]));
        let mean = values().sum::<f64>() / n;
        let variance = values().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let block = &mut sums[pixel / width / SIDE * across + pixel % width / SIDE];
        *block = (block.0 + mean, block.1 + variance, block.2 + 1.0);
    }
    let mut all: Vec<f64> = sums
        .iter()
        .filter(|block| block.0 > 0.0)
        .map(|(mean, variance, count)| (variance * count).sqrt() / mean)
        .collect();
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}
