//! Measures rendered scenes: every pixel against a reference.

use crate::BenchError;
use crate::colors::White;
use crate::integral::Measured;
use crate::statistics::mean_and_variance_of_mean;
use spectra_core::Isa;
use spectra_core::frame::ExposureFrame;
use spectra_render::{Control, RenderOptions, Renderer, Threads};
use spectra_scene::Scene;
use std::time::Instant;

/// Number of renders averaged for the reference.
pub(crate) const RENDERS: u32 = 8;

/// Renders the scene with `samples` samples per pixel for each seed. Returns each render with the seconds of tracing; the scene is prepared
/// only once.
pub(crate) fn renders(
    scene: &mut Scene,
    strategy: &str,
    samples: u32,
    seeds: impl Iterator<Item = u64>,
    threads: usize,
    isa: Isa,
) -> Result<Vec<(ExposureFrame, f64)>, BenchError> {
    scene.render.samples = samples;
    scene.render.rays = u64::from(samples) * scene.imager.size().pixels() as u64;
    let failed = |error| BenchError::Render { strategy: strategy.to_owned(), error };
    let renderer =
        Renderer::new(scene.clone(), &RenderOptions { isa, workers: &Threads(threads), ..RenderOptions::default() })
            .map_err(failed)?;
    let one = |seed| {
        let begun = Instant::now();
        let rendering = renderer.reseeded(seed).run(&Threads(threads), &Control::new()).map_err(failed)?;
        Ok((rendering.exposure, begun.elapsed().as_secs_f64()))
    };
    seeds.map(one).collect()
}

/// The mean of several renders, with its uncertainty.
#[derive(Debug)]
pub(crate) struct Truth {
    /// Exposure of each pixel, for each channel.
    planes: Vec<Vec<f64>>,
    /// Sum over pixels of the squared exposure, for each channel.
    power: Vec<f64>,
    /// Sum over pixels of the variance of the mean, for each channel.
    variance: Vec<f64>,
    /// Sum of the exposure over pixels, and the relative variance of that sum, for each channel.
    totals: Vec<f64>,
    total_variance: Vec<f64>,
}

impl Truth {
    /// Averages renders with different seeds; at least two.
    pub(crate) fn of(renders: &[ExposureFrame]) -> Self {
        let channels = renders[0].channels.len();
        let many = renders.len() as f64;
        let mut truth = Self {
            planes: Vec::new(),
            power: vec![0.0; channels],
            variance: vec![0.0; channels],
            totals: vec![0.0; channels],
            total_variance: vec![0.0; channels],
        };
        for channel in 0..channels {
            let values = |pixel: usize| renders.iter().map(move |r| f64::from(r.channels[channel].values[pixel]));
            let plane: Vec<f64> = (0..renders[0].size.pixels()).map(|p| values(p).sum::<f64>() / many).collect();
            truth.power[channel] = plane.iter().map(|v| v * v).sum();
            let scatter: f64 =
                plane.iter().enumerate().map(|(p, m)| values(p).map(|v| (v - m) * (v - m)).sum::<f64>()).sum();
            truth.variance[channel] = scatter / (many * (many - 1.0));
            let totals: Vec<f64> = renders.iter().map(|r| total(r, channel)).collect();
            let (mean, variance) = mean_and_variance_of_mean(&totals);
            truth.totals[channel] = mean;
            truth.total_variance[channel] = if mean == 0.0 { 0.0 } else { variance / (mean * mean) };
            truth.planes.push(plane);
        }
        truth
    }

    /// Returns the channels that recorded any light.
    pub(crate) fn seen(&self) -> Vec<usize> {
        (0..self.planes.len()).filter(|c| self.power[*c] > 0.0 && self.totals[*c] != 0.0).collect()
    }

    /// Relative RMS error of the mean itself over these channels.
    pub(crate) fn error(&self, seen: &[usize]) -> f64 {
        (seen.iter().map(|c| self.variance[*c] / self.power[*c]).sum::<f64>() / seen.len() as f64).sqrt()
    }

    /// Compares renders of one strategy with the truth. `light` is the color of the source, given if the channels `xyz` are X, Y, Z.
    pub(crate) fn compare(
        &self,
        renders: &[ExposureFrame],
        seen: &[usize],
        xyz: Option<([usize; 3], [f64; 3])>,
    ) -> Measured {
        let squared = |render: &ExposureFrame| {
            let of = |c: &usize| {
                let pairs = self.planes[*c].iter().zip(&render.channels[*c].values);
                let sum: f64 = pairs.map(|(a, b)| (f64::from(*b) - a) * (f64::from(*b) - a)).sum();
                // Subtract the variance of the truth: render and truth are independent, so their squared difference contains the variance
                // of both.
                (sum - self.variance[*c]) / self.power[*c]
            };
            seen.iter().map(of).sum::<f64>() / seen.len() as f64
        };
        let relative = |c: &usize| renders.iter().map(|r| total(r, *c) / self.totals[*c] - 1.0).collect();
        Measured {
            squared: renders.iter().map(squared).collect(),
            relative: seen.iter().map(relative).collect(),
            truth_variance: seen.iter().map(|c| self.total_variance[*c]).collect(),
            seconds: f64::INFINITY,
            ciede2000: xyz.and_then(|(channels, light)| self.differences(renders, channels, light)),
        }
    }

    fn differences(&self, renders: &[ExposureFrame], channels: [usize; 3], light: [f64; 3]) -> Option<f64> {
        let lightest = self.planes[channels[1]].iter().fold(0.0_f64, |a, b| a.max(*b));
        let white = White::new(light, lightest)?;
        let pixels = self.planes[channels[1]].len();
        let of = |r: &ExposureFrame| {
            let one = |p: usize| {
                let seen = channels.map(|c| f64::from(r.channels[c].values[p]));
                white.difference(seen, channels.map(|c| self.planes[c][p]))
            };
            (0..pixels).map(one).sum::<f64>() / pixels as f64
        };
        Some(renders.iter().map(of).sum::<f64>() / renders.len() as f64)
    }
}

fn total(render: &ExposureFrame, channel: usize) -> f64 {
    render.channels[channel].values.iter().map(|v| f64::from(*v)).sum()
}
