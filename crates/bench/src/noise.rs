//! How long a clean picture takes: noise between independent seeds, against time.
//!
//! A scene is rendered with as many samples as the time allows (the largest power of two), and as many by each further seed. In
//! every square of [`SIDE`] x [`SIDE`] pixels the noise of luminance is the root of the pixels' mean variance over their mean.
//! What it is after another time, and when it is 1 %, follows from its falling with the root of the samples.

use crate::BenchError;
use serde::Serialize;
use spectra_core::Isa;
use spectra_core::frame::ExposureFrame;
use spectra_render::{Control, Light, Renderer, Threads};
use spectra_scene::Scene;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Pixels a side of the squares that noise is measured in.
const SIDE: usize = 8;
/// Squares that hold less than this part of the mean light are not judged: nothing is seen there.
const DARK: f64 = 1e-3;
/// The noise that a time is given for.
const CLEAN: f64 = 0.01;
/// Most samples.
const MOST: u64 = 1 << 20;

/// What is measured of each scene.
#[derive(Clone, Debug)]
pub struct NoiseSettings {
    /// Seeds, 2 at least.
    pub seeds: u64,
    /// Seconds of tracing for each seed.
    pub seconds: f64,
    /// Values of `render.direction` that are tried.
    pub directions: Vec<String>,
    /// Threads to render on.
    pub threads: usize,
    /// Instruction set.
    pub isa: Isa,
}

/// The noise of a scene by one choice of estimators.
#[derive(Clone, Debug, Serialize)]
pub struct NoiseRow {
    /// Name of the scene.
    pub scene: String,
    /// What `render.direction` said.
    pub direction: String,
    /// The estimators that it came to.
    pub estimators: Vec<&'static str>,
    /// The channel whose noise it is.
    pub channel: String,
    /// Samples a pixel, or as many forward rays.
    pub samples: u64,
    /// Seconds before the first ray: pupils, pilots.
    pub ready_s: f64,
    /// Seconds of tracing, a mean over the seeds.
    pub seconds: f64,
    /// Rays a second.
    pub rays_per_s: f64,
    /// Noise at these samples: the median over the squares, and what 95 % of them stay below.
    pub noise: [f64; 2],
    /// The same after the seconds that were asked for.
    pub noise_then: [f64; 2],
    /// Seconds to 1 %: of the median, and of 95 % of the squares.
    pub clean_s: [f64; 2],
}

/// Measures a scene file with `overrides` (texts `path=value`) by each direction; those that it cannot be rendered by are left
/// out. `tell` is given a line on what is being measured.
///
/// # Errors
/// [`BenchError`].
pub fn noise(
    path: &Path,
    overrides: &[String],
    settings: &NoiseSettings,
    tell: &mut dyn FnMut(&str),
) -> Result<Vec<NoiseRow>, BenchError> {
    if settings.seeds < 2 {
        return Err(BenchError::Settings("seeds: 2 at least, or there is no scatter to judge by"));
    }
    // What is wrong whatever the direction is said as it is.
    spectra_scene::load(path, overrides)?;
    let mut rows = Vec::new();
    for direction in &settings.directions {
        let set = [overrides, &[format!("render.direction={direction}")]].concat();
        let Ok(scene) = spectra_scene::load(path, &set) else { continue };
        tell(&format!("{}: {direction}", scene.name));
        rows.push(row(scene, direction, settings)?);
    }
    Ok(rows)
}

fn row(scene: Scene, direction: &str, settings: &NoiseSettings) -> Result<NoiseRow, BenchError> {
    let scene = Arc::new(scene);
    let failed = |error| BenchError::Render { strategy: direction.to_owned(), error };
    let (workers, control) = (Threads(settings.threads), Control::new());
    let mut samples = 0;
    let (mut spent_s, mut rays) = (0.0, 0);
    let mut estimators = Vec::new();
    let mut frames: Vec<ExposureFrame> = Vec::new();
    let begun = Instant::now();
    let ready = Renderer::on(Arc::clone(&scene), settings.isa, &Threads(settings.threads)).map_err(failed)?;
    let ready_s = begun.elapsed().as_secs_f64();
    for seed in 0..settings.seeds {
        let renderer = ready.reseeded(scene.render.seed.wrapping_add(seed << 32));
        let mut light: Light = renderer.begin().map_err(failed)?;
        let begun = Instant::now();
        if samples == 0 {
            // The first seed finds how many there is time for.
            samples = 1;
            renderer.advance(&mut light, samples, &workers, &control).map_err(failed)?;
            while samples < MOST && 2.0 * begun.elapsed().as_secs_f64() <= settings.seconds {
                samples *= 2;
                renderer.advance(&mut light, samples, &workers, &control).map_err(failed)?;
            }
        } else {
            renderer.advance(&mut light, samples, &workers, &control).map_err(failed)?;
        }
        spent_s += begun.elapsed().as_secs_f64();
        let rendering = renderer.look(&scene, &light).map_err(failed)?;
        rays += rendering.rays;
        estimators = rendering.estimators;
        frames.push(rendering.exposure);
    }
    let seconds = spent_s / settings.seeds as f64;
    let channel = channel(&frames[0]);
    let noise = of_squares(&frames, channel).ok_or(BenchError::Dark)?;
    Ok(NoiseRow {
        scene: scene.name.clone(),
        direction: direction.to_owned(),
        estimators,
        channel: frames[0].channels[channel].name.clone(),
        samples,
        ready_s,
        seconds,
        rays_per_s: rays as f64 / spent_s,
        noise,
        noise_then: noise.map(|noise| noise * (seconds / settings.seconds).sqrt()),
        clean_s: noise.map(|noise| seconds * (noise / CLEAN) * (noise / CLEAN)),
    })
}

/// Luminance, or else the first channel.
fn channel(frame: &ExposureFrame) -> usize {
    frame.channels.iter().position(|c| c.name == "Y").unwrap_or(0)
}

/// Median and 95th percentile of the noise of the squares; `None` where no square has light.
fn of_squares(frames: &[ExposureFrame], channel: usize) -> Option<[f64; 2]> {
    let many = frames.len() as f64;
    let (width, height) = (frames[0].size.width_px as usize, frames[0].size.height_px as usize);
    let of = |pixel: usize| frames.iter().map(move |f| f64::from(f.channels[channel].values[pixel]));
    let all = frames[0].channels[channel].values.iter().map(|v| f64::from(*v)).sum::<f64>() / (width * height) as f64;
    let mut noise = Vec::new();
    for top in (0..height).step_by(SIDE) {
        for left in (0..width).step_by(SIDE) {
            let rows = top..(top + SIDE).min(height);
            let pixels = rows.flat_map(|row| (left..(left + SIDE).min(width)).map(move |column| row * width + column));
            let (mut sum, mut variance, mut count) = (0.0, 0.0, 0.0);
            for pixel in pixels {
                let mean = of(pixel).sum::<f64>() / many;
                variance += of(pixel).map(|v| (v - mean) * (v - mean)).sum::<f64>() / (many - 1.0);
                sum += mean;
                count += 1.0;
            }
            if sum > DARK * all * count {
                noise.push((variance / count).sqrt() / (sum / count));
            }
        }
    }
    noise.sort_by(f64::total_cmp);
    let at =
        |share: f64| noise.get(((noise.len() as f64 * share) as usize).min(noise.len().saturating_sub(1))).copied();
    Some([at(0.5)?, at(0.95)?])
}

/// A table of some rows, in Markdown; `machine` says what they were measured on.
#[must_use]
pub fn noise_table(rows: &[NoiseRow], settings: &NoiseSettings, machine: &str) -> String {
    let then = settings.seconds;
    let mut text = format!(
        "{machine}\n{} seeds; noise of {SIDE} x {SIDE} pixels: median, 95th percentile\n\n\
         | scene | direction | samples | s | M rays/s | noise, % | after {then} s, % | s to {} % |\n\
         |---|---|---|---|---|---|---|---|\n",
        settings.seeds,
        100.0 * CLEAN
    );
    for row in rows {
        let estimators = row.estimators.join(" + ");
        let direction =
            if row.direction == estimators { estimators } else { format!("{} ({estimators})", row.direction) };
        let [noise, then] = [row.noise, row.noise_then].map(|[a, b]| format!("{:.2}, {:.2}", 100.0 * a, 100.0 * b));
        text.push_str(&format!(
            "| {} | {direction} | {} | {:.1} | {:.1} | {noise} | {then} | {:.1}, {:.1} |\n",
            row.scene,
            row.samples,
            row.seconds,
            row.rays_per_s / 1e6,
            row.clean_s[0],
            row.clean_s[1]
        ));
    }
    text
}
