//! Measures how clean ghosts are after how much time, and what the search for their rays gains.
//!
//! Only the ghosts of a scene are rendered, with several seeds. They are rendered once as in its pictures, and once with the same number of
//! rays for each path, spread over the whole front. Blocks of [`SIDE`] x [`SIDE`] pixels with more than [`DIM`] of the light of the
//! brightest one are judged. The noise of a block is the scatter of its sum between the seeds, divided by its mean.

use crate::BenchError;
use serde::Serialize;
use spectra_core::Isa;
use spectra_core::frame::ExposureFrame;
use spectra_render::{Control, GhostRays, RenderOptions, Renderer, Threads, Traced};
use spectra_scene::Scene;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Side of the blocks, pixels.
const SIDE: usize = 32;
/// Blocks with less than this fraction of the light of the brightest are not judged.
const DIM: f64 = 1e-4;
/// Target noise: the time to reach it is reported.
const CLEAN: f64 = 0.02;

/// Settings of a measurement of ghosts.
#[derive(Clone, Copy, Debug)]
pub struct GhostSettings {
    /// Number of seeds, at least 2.
    pub seeds: u64,
    /// Number of threads for rendering.
    pub threads: usize,
    /// Instruction set to use.
    pub isa: Isa,
    /// Function that returns the processor time in seconds that all threads of this program have used so far. `None` if the
    /// system does not report it. Unlike the clock, this time does not count other programs that run at the same time.
    pub processor_s: fn() -> Option<f64>,
}

/// Noise of ghosts for one way to distribute rays.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct GhostNoise {
    /// Number of rays traced with each seed.
    pub rays: u64,
    /// Preparation time before the first ray (pilot, ledger), s.
    pub ready_s: f64,
    /// Time of tracing, averaged over the seeds, s.
    pub trace_s: f64,
    /// Number of blocks that are judged.
    pub blocks: usize,
    /// Root mean square of the relative noise of the blocks.
    pub rms: f64,
    /// 95th percentile of the relative noise of the blocks.
    pub most: f64,
    /// Relative noise of the worst block; overestimated for many blocks and few seeds.
    pub worst: f64,
    /// Relative noise of single pixels: root mean square within a block, median over the blocks.
    pub pixel: f64,
}

/// Results of the measurement of one scene.
#[derive(Clone, Debug, Serialize)]
pub struct GhostRow {
    /// Name of the scene.
    pub scene: String,
    /// Number of ghost paths.
    pub paths: usize,
    /// Width and height of the frame, pixels.
    pub pixels: [u32; 2],
    /// Number of samples.
    pub samples: u32,
    /// Name of the channel whose noise is reported.
    pub channel: String,
    /// Whether times are processor times instead of clock times.
    pub processor_time: bool,
    /// Noise with rays distributed by the search, as in pictures.
    pub found: GhostNoise,
    /// Noise with the same number of rays for each path, spread over the whole front.
    pub even: GhostNoise,
    /// Time that `even` needs, divided by the time that `found` needs, to reach the same noise (root mean square over the
    /// blocks), without preparation.
    pub gain: f64,
    /// Time to reach 2 % noise in 95 % of the blocks with `found`, including preparation, s.
    pub clean_s: f64,
}

/// Measures the noise of ghosts in a scene file with `overrides` (texts `path=value`). `tell` receives a line about the current
/// measurement.
///
/// # Errors
/// [`BenchError`]: fewer than 2 seeds, an invalid scene, no ghosts or no light, or a failed render.
pub fn ghosts(
    path: &Path,
    overrides: &[String],
    settings: &GhostSettings,
    tell: &mut dyn FnMut(&str),
) -> Result<GhostRow, BenchError> {
    if settings.seeds < 2 {
        return Err(BenchError::Settings("seeds: give at least 2, because errors are judged by their scatter"));
    }
    let scene = crate::scene::load(path, overrides)?;
    let mut paths = 0;
    let mut judged = None;
    let mut one = |rays: GhostRays, words: &str| -> Result<GhostNoise, BenchError> {
        tell(&format!("{}: {words}", scene.name));
        let (noise, frames, count) = rendered(&scene, rays, settings)?;
        paths = count;
        // Judge both in the blocks that are bright in the first, cleaner one.
        let blocks = judged.get_or_insert_with(|| Blocks::of(&frames));
        noise.judged(blocks, &frames).ok_or(BenchError::Dark)
    };
    let found = one(GhostRays::Found, "rays distributed by the search")?;
    let even = one(GhostRays::Even, "rays spread over the whole front")?;
    let size = scene.imager.size();
    Ok(GhostRow {
        scene: scene.name.clone(),
        paths,
        pixels: [size.width_px, size.height_px],
        samples: scene.render.samples,
        channel: judged.map(|blocks| blocks.name).unwrap_or_default(),
        processor_time: (settings.processor_s)().is_some(),
        found,
        even,
        gain: even.rms * even.rms * even.trace_s / (found.rms * found.rms * found.trace_s),
        clean_s: found.ready_s + found.trace_s * (found.most / CLEAN) * (found.most / CLEAN),
    })
}

/// Renders the ghosts of a scene with each seed. Returns the times and numbers of rays, the frames, and the number of paths.
fn rendered(
    scene: &Scene,
    rays: GhostRays,
    settings: &GhostSettings,
) -> Result<(GhostNoise, Vec<ExposureFrame>, usize), BenchError> {
    let failed = |error| BenchError::Render { strategy: "ghosts".to_owned(), error };
    let begun = Instant::now();
    let now = || (settings.processor_s)().unwrap_or_else(|| begun.elapsed().as_secs_f64());
    let (workers, control) = (Threads(settings.threads), Control::new());
    let many = settings.seeds as f64;
    let mut noise = GhostNoise {
        rays: 0,
        ready_s: 0.0,
        trace_s: 0.0,
        blocks: 0,
        rms: f64::NAN,
        most: f64::NAN,
        worst: f64::NAN,
        pixel: f64::NAN,
    };
    let (mut frames, mut paths) = (Vec::new(), 0);
    let start = now();
    let ready = Renderer::new(
        Arc::new(scene.clone()),
        &RenderOptions {
            isa: settings.isa,
            traced: Traced::Ghosts(rays),
            workers: &workers,
            ..RenderOptions::default()
        },
    )
    .map_err(failed)?;
    ready.ledger().ok_or(BenchError::Dark)?;
    noise.ready_s = now() - start;
    for seed in 0..settings.seeds {
        let start = now();
        let renderer = ready.reseeded(scene.render.seed.wrapping_add(seed << 32));
        let rendering = renderer.run(&workers, &control).map_err(failed)?;
        noise.trace_s += (now() - start) / many;
        noise.rays = rendering.rays;
        paths = rendering.ledger.map_or(0, |ledger| ledger.paths.len());
        frames.push(rendering.exposure);
    }
    Ok((noise, frames, paths))
}

/// The blocks that are judged.
struct Blocks {
    channel: usize,
    name: String,
    /// Mean light of each block with the rays of the search, and its pixels.
    pixels: Vec<(f64, Vec<usize>)>,
}

impl Blocks {
    fn of(frames: &[ExposureFrame]) -> Self {
        let first = &frames[0];
        let channel = first.channels.iter().position(|c| c.name == "Y").unwrap_or(0);
        let (width, height) = (first.size.width_px as usize, first.size.height_px as usize);
        let mut all = Vec::new();
        for top in (0..height).step_by(SIDE) {
            for left in (0..width).step_by(SIDE) {
                let rows = top..(top + SIDE).min(height);
                let row = |row| (left..(left + SIDE).min(width)).map(move |column| row * width + column);
                let pixels: Vec<usize> = rows.flat_map(row).collect();
                let light: f64 = frames.iter().map(|f| light_of(f, channel, &pixels)).sum();
                all.push((light, pixels));
            }
        }
        let brightest = all.iter().fold(0.0_f64, |most, (light, _)| most.max(*light));
        all.retain(|(light, _)| *light > DIM * brightest);
        let pixels = all.into_iter().map(|(light, pixels)| (light / frames.len() as f64, pixels)).collect();
        Self { channel, name: first.channels[channel].name.clone(), pixels }
    }
}

fn light_of(frame: &ExposureFrame, channel: usize, pixels: &[usize]) -> f64 {
    pixels.iter().map(|p| f64::from(frame.channels[channel].values[*p])).sum()
}

fn variance(values: &[f64]) -> f64 {
    let many = values.len() as f64;
    let mean = values.iter().sum::<f64>() / many;
    values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (many - 1.0)
}

impl GhostNoise {
    fn judged(self, blocks: &Blocks, frames: &[ExposureFrame]) -> Option<Self> {
        let channel = blocks.channel;
        // Divide by the light of the cleaner way for both: rays that are spread evenly may miss a block with every seed.
        let of_block = |(light, pixels): &(f64, Vec<usize>)| {
            let sums: Vec<f64> = frames.iter().map(|frame| light_of(frame, channel, pixels)).collect();
            let of_pixel = |pixel: &usize| {
                let values: Vec<f64> = frames.iter().map(|f| f64::from(f.channels[channel].values[*pixel])).collect();
                variance(&values)
            };
            let many = pixels.len() as f64;
            let single = pixels.iter().map(of_pixel).sum::<f64>() / many;
            (variance(&sums) / (light * light), single.sqrt() * many / light)
        };
        let (mut squares, mut single): (Vec<f64>, Vec<f64>) = blocks.pixels.iter().map(of_block).unzip();
        squares.sort_by(f64::total_cmp);
        single.sort_by(f64::total_cmp);
        let at = |share: f64| (squares.len() as f64 * share) as usize;
        Some(Self {
            blocks: squares.len(),
            rms: (squares.iter().sum::<f64>() / squares.len() as f64).sqrt(),
            most: squares.get(at(0.95))?.sqrt(),
            worst: squares.last()?.sqrt(),
            pixel: *single.get(single.len() / 2)?,
            ..self
        })
    }
}

/// Formats rows as a Markdown table; `machine` describes what they were measured on.
#[must_use]
pub fn ghost_table(rows: &[GhostRow], settings: &GhostSettings, machine: &str) -> String {
    let unit = if rows.iter().all(|row| row.processor_time) { "CPU s" } else { "s" };
    let mut text = format!(
        "{machine}\n{} seeds; noise of {SIDE} x {SIDE} pixels above {DIM:e} of the brightest: root of the mean square, 95 %, worst\n\n\
         | scene | rays | M | {unit} before | {unit} | blocks | noise, % | pixel noise, % | gain | {unit} to {} % |\n\
         |---|---|---|---|---|---|---|---|---|---|\n",
        settings.seeds,
        100.0 * CLEAN
    );
    for row in rows {
        let line = |words: &str, noise: &GhostNoise, rest: &str| {
            format!(
                "| {} | {words} | {:.1} | {:.1} | {:.1} | {} | {:.2}, {:.2}, {:.1} | {:.0} | {rest} |\n",
                row.scene,
                noise.rays as f64 / 1e6,
                noise.ready_s,
                noise.trace_s,
                noise.blocks,
                100.0 * noise.rms,
                100.0 * noise.most,
                100.0 * noise.worst,
                100.0 * noise.pixel,
            )
        };
        text.push_str(&line("found", &row.found, &format!("{:.1} | {:.1}", row.gain, row.clean_s)));
        text.push_str(&line("even", &row.even, "1 | "));
    }
    text
}
