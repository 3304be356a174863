//! Measures how long a clean picture takes: the noise between independent seeds as a function of time.
//!
//! The first seed renders a scene with as many samples as the time allows (the largest power of two). Each further seed uses the same
//! number. In every square of [`SIDE`] x [`SIDE`] pixels the noise is the root of the mean variance of the pixels divided by their mean
//! luminance. Noise falls with the root of the samples. This gives the noise after another time, and the time to reach 1 %.

use crate::BenchError;
use serde::Serialize;
use spectra_core::Isa;
use spectra_core::frame::ExposureFrame;
use spectra_render::{Control, Light, RenderOptions, Renderer, Threads};
use spectra_scene::Scene;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Side of the squares in which noise is measured, pixels.
const SIDE: usize = 8;
/// Squares with less than this fraction of the mean light are not judged, because noise is not visible there.
const DARK: f64 = 1e-3;
/// Target noise: the time to reach it is reported.
const CLEAN: f64 = 0.01;
/// Largest number of samples.
const MOST: u64 = 1 << 20;

/// Settings of a noise measurement.
#[derive(Clone, Debug)]
pub struct NoiseSettings {
    /// Number of seeds, at least 2.
    pub seeds: u64,
    /// Time of tracing for each seed, s.
    pub seconds: f64,
    /// Values of `render.direction` to measure.
    pub directions: Vec<String>,
    /// Number of threads for rendering.
    pub threads: usize,
    /// Instruction set to use.
    pub isa: Isa,
}

/// Noise of a scene for one value of `render.direction`.
#[derive(Clone, Debug, Serialize)]
pub struct NoiseRow {
    /// Name of the scene.
    pub scene: String,
    /// Value of `render.direction` that was set.
    pub direction: String,
    /// Estimators that the renderer used for it.
    pub estimators: Vec<&'static str>,
    /// Name of the channel whose noise is reported.
    pub channel: String,
    /// Number of samples per pixel, or of forward rays per pixel.
    pub samples: u64,
    /// Preparation time before the first ray (pupils, pilots), s.
    pub ready_s: f64,
    /// Time of tracing, averaged over the seeds, s.
    pub seconds: f64,
    /// Number of rays per second.
    pub rays_per_s: f64,
    /// Relative noise at these samples: the median and the 95th percentile over the squares.
    pub noise: [f64; 2],
    /// Relative noise after the requested time (extrapolated): the median and the 95th percentile over the squares.
    pub noise_then: [f64; 2],
    /// Time to reach 1 % noise, s: for the median and for 95 % of the squares.
    pub clean_s: [f64; 2],
}

/// Measures the noise of a scene file with `overrides` (texts `path=value`) for each direction of `settings`. Directions in which
/// the scene cannot be rendered are left out. `tell` receives a line about the current measurement.
///
/// # Errors
/// [`BenchError`]: fewer than 2 seeds, an invalid scene, no recorded light, or a failed render.
pub fn noise(
    path: &Path,
    overrides: &[String],
    settings: &NoiseSettings,
    tell: &mut dyn FnMut(&str),
) -> Result<Vec<NoiseRow>, BenchError> {
    if settings.seeds < 2 {
        return Err(BenchError::Settings("seeds: give at least 2, because errors are judged by their scatter"));
    }
    // Load the scene as it is first, to report errors that do not depend on the direction.
    crate::scene::load(path, overrides)?;
    let mut rows = Vec::new();
    for direction in &settings.directions {
        let set = [overrides, &[format!("render.direction={direction}")]].concat();
        let Ok(scene) = crate::scene::load(path, &set) else { continue };
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
    let ready = Renderer::new(
        Arc::clone(&scene),
        &RenderOptions { isa: settings.isa, workers: &Threads(settings.threads), ..RenderOptions::default() },
    )
    .map_err(failed)?;
    let ready_s = begun.elapsed().as_secs_f64();
    for seed in 0..settings.seeds {
        let renderer = ready.reseeded(scene.render.seed.wrapping_add(seed << 32));
        let mut light: Light = renderer.begin().map_err(failed)?;
        let begun = Instant::now();
        if samples == 0 {
            // The first seed determines how many samples the time allows.
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
        let rendering = renderer.rendering(&scene, &light).map_err(failed)?;
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

/// Returns the index of the luminance channel, or of the first channel if there is none.
fn channel(frame: &ExposureFrame) -> usize {
    frame.channels.iter().position(|c| c.name == "Y").unwrap_or(0)
}

/// Returns the median and the 95th percentile of the noise of the squares; `None` if no square has light.
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

/// Formats rows as a Markdown table; `machine` describes what they were measured on.
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
