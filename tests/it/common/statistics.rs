//! Renders pictures with independent seeds and estimates figures from them.

use spectra_optics::Effort;
use spectra_render::{Control, RenderOptions, Renderer, Rendering, Threads};
use spectra_scene::Scene;
use std::ops::Range;
use std::path::Path;

/// Loads a scene file with these settings, each as `section.key=value`.
pub fn load(path: &Path, settings: &[&str]) -> Scene {
    let settings: Vec<String> = settings.iter().map(|s| (*s).to_owned()).collect();
    spectra_scene::load(path, &settings).unwrap_or_else(|faults| panic!("{faults}"))
}

/// Prepares a scene once: what is searched before the first ray serves all seeds.
pub fn ready(scene: Scene) -> Renderer {
    Renderer::new(scene, &RenderOptions { workers: &Threads(2), ..RenderOptions::default() })
        .expect("the scene can be rendered")
}

/// Prepares a scene as a draft. The search for pupils and ghosts takes a part of the time, so more rays are lost on their way. Use it
/// for figures that do not depend on how many are lost.
pub fn drafted(scene: Scene) -> Renderer {
    Renderer::new(scene, &RenderOptions { effort: Effort::Draft, workers: &Threads(2), ..RenderOptions::default() })
        .expect("the scene can be rendered")
}

/// Renders all samples on two threads.
pub fn rendered(renderer: &Renderer) -> Rendering {
    renderer.run(&Threads(2), &Control::new()).expect("rendered")
}

/// Renders the picture of each seed and returns the figures that `of` computes from it.
pub fn over_seeds(renderer: &Renderer, seeds: Range<u64>, of: impl Fn(&Rendering) -> Vec<f64>) -> Vec<Vec<f64>> {
    seeds.map(|seed| of(&rendered(&renderer.reseeded(seed)))).collect()
}

/// A figure with a statistical error.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    pub mean: f64,
    /// Standard error of the mean.
    pub error: f64,
}

impl Estimate {
    /// Returns the estimate from independent values.
    pub fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
        Self { mean, error: (variance / n).sqrt() }
    }

    /// Returns the distance between two estimates in standard errors of their difference.
    pub fn apart(self, other: Self) -> f64 {
        (self.mean - other.mean).abs() / self.error.hypot(other.error)
    }
}

/// Returns an estimate of each figure from the figures of all seeds.
pub fn estimates(runs: &[Vec<f64>]) -> Vec<Estimate> {
    let column = |at: usize| runs.iter().map(|run| run[at]).collect::<Vec<_>>();
    (0..runs[0].len()).map(|at| Estimate::of(&column(at))).collect()
}

/// Returns the mean illuminance of each part of the frame, for `columns` by `rows` parts, row by row.
pub fn regions(rendering: &Rendering, columns: usize, rows: usize) -> Vec<f64> {
    let frame = &rendering.exposure;
    let y = &frame.channel("Y").expect("an XYZ imager").values;
    let (width, height) = (frame.size.width_px as usize, frame.size.height_px as usize);
    let mut sums = vec![0.0; columns * rows];
    for (pixel, value) in y.iter().enumerate() {
        sums[pixel / width * rows / height * columns + pixel % width * columns / width] += f64::from(*value);
    }
    sums.iter().map(|sum| sum / (width * height / sums.len()) as f64).collect()
}

/// Returns the illuminance of each pixel.
pub fn pixels(rendering: &Rendering) -> Vec<f64> {
    rendering.exposure.channel("Y").expect("an XYZ imager").values.iter().map(|y| f64::from(*y)).collect()
}

/// Returns the bits of all channels.
pub fn bits(rendering: &Rendering) -> Vec<u32> {
    rendering.exposure.channels.iter().flat_map(|c| c.values.iter().map(|v| v.to_bits())).collect()
}
