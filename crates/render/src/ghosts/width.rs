//! How wide footprints have to be: by how noisy ghosts are where each ray adds to one pixel.

use super::{Ghosts, SCALE_RAYS, spans};
use crate::Workers;
use crate::error::RenderError;
use crate::footprint::MOST_HALF;
use crate::pipeline::ThreadState;
use spectra_core::batch::pixel_and_channel;
use spectra_core::workers::each_of;

/// The noise of a pixel that footprints are to leave in a picture of so many samples, as a part of the light. Neighbors share most of it:
/// about the plane through 16 x 16 pixels it is some six tenths of that.
const NOISE: f64 = 0.021;
const SAMPLES: f64 = 64.0;
/// Of the samples before that, whose footprints are larger, the noise is less by this factor in all (squared).
const EARLIER: f64 = 2.0 / 3.0;
/// Parts of the frame that are looked at, across, and how many rays one has at least that is taken into account.
const ACROSS: usize = 20;
const LEAST: f64 = 6.0;

/// How far footprints reach to each side, in pixels, sample by sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Width {
    /// The side of the last sample of [`SAMPLES`]; 0 where there is no noise.
    side: f64,
}

impl Width {
    /// For so much noise of a pixel in a picture of one sample: variance over the square of the mean.
    fn for_noise(variance: f64) -> Self {
        let pixels = EARLIER * variance / SAMPLES / (NOISE * NOISE);
        Self { side: pixels.sqrt() }
    }

    /// That of a sample: the area falls with the root of its number, so that both noise and blur go to nothing. It does not rest on how
    /// many samples there will be, so light that goes on has the bits of light in one go.
    pub fn of_sample(&self, sample: u64) -> f64 {
        (0.5 * (self.side * (SAMPLES / (sample + 1) as f64).sqrt().sqrt() - 1.0)).clamp(0.0, MOST_HALF)
    }

    /// The noise that is left of a pixel, as a part of its light, in a picture of so many samples whose footprints reach no farther than
    /// `most_half` to each side.
    pub fn noise(&self, samples: u64, most_half: f64) -> f64 {
        let variance = self.side * self.side * SAMPLES * NOISE * NOISE / EARLIER;
        let pixels = |sample: u64| (2.0 * self.of_sample(sample).min(most_half) + 1.0).powi(2);
        let left: f64 = (0..samples).map(|sample| variance / pixels(sample)).sum();
        left.sqrt() / samples.max(1) as f64
    }

    pub fn is_none(&self) -> bool {
        self.side == 0.0
    }
}

/// What a ray brought to a part of the frame and a channel, times how many rays it stands for.
type Part = (u32, f64, f64);

/// The width for ghosts whose rays are shared out already.
pub(super) fn found(ghosts: &Ghosts, workers: &dyn Workers) -> Result<Width, RenderError> {
    let size = ghosts.pipeline.scene.imager.size();
    let (width, height) = (size.width_px as usize, size.height_px as usize);
    let side = width.max(height).div_ceil(ACROSS);
    let across = width.div_ceil(side);
    let channels = ghosts.pipeline.responses.channels();
    let part_of = |pixel: usize| pixel / width / side * across + pixel % width / side;
    let each = each_of(
        workers,
        ghosts.plan.ways.len(),
        || ghosts.state(ghosts.pipeline.scene.render.batch),
        |state, at| {
            if workers.should_stop() {
                return Err(RenderError::Stopped);
            }
            Ok(parts(ghosts, state, at, |pixel| part_of(pixel) * channels))
        },
    )?;
    let parts = height.div_ceil(side) * across;
    let mut sums = vec![[0.0; 2]; parts * channels];
    for (cell, value, rays) in each.into_iter().flatten() {
        let [light, square] = &mut sums[cell as usize];
        *light += value * rays;
        *square += value * value * rays;
    }
    let pixels = |part: usize| {
        let (column, row) = (part % across * side, part / across * side);
        ((width - column).min(side) * (height - row).min(side)) as f64
    };
    let noise = |(cell, [light, square]): (usize, &[f64; 2])| {
        let variance = square / (light * light);
        (variance * LEAST < 1.0).then_some(variance * pixels(cell / channels))
    };
    let mut variances: Vec<f64> = sums.iter().enumerate().filter_map(noise).collect();
    variances.sort_unstable_by(f64::total_cmp);
    let a_block = variances.get(variances.len() / 2).copied().unwrap_or(f64::MAX);
    Ok(Width::for_noise(a_block / ghosts.plan.blocks_a_sample as f64))
}

/// What a block's rays of a path bring.
fn parts(ghosts: &Ghosts, state: &mut ThreadState, at: usize, first: impl Fn(usize) -> usize) -> Vec<Part> {
    let all = ghosts.plan.ways[at].rays;
    let some = all.min(SCALE_RAYS);
    let stands_for = all as f64 / some as f64;
    let channels = ghosts.pipeline.responses.channels();
    let mut parts = Vec::new();
    for span in spans(0..some, state.rays.capacity()) {
        ghosts.batch(state, at, span, |_, _| {});
        let brought = ghosts.brought(state);
        for (tag, brought) in state.rays.tags().iter().zip(brought.chunks_exact(channels)) {
            let first = first(pixel_and_channel(*tag).0 as usize);
            let lit = brought.iter().enumerate().filter(|(_, value)| **value != 0.0);
            parts.extend(lit.map(|(channel, value)| ((first + channel) as u32, *value, stands_for)));
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_samples_have_smaller_footprints() {
        let width = Width::for_noise(2.0);
        let halves = [0, 15, 63, 255, 1 << 20].map(|sample| width.of_sample(sample));
        assert!(halves.is_sorted_by(|a, b| a >= b) && halves[0] < MOST_HALF && halves[4] == 0.0, "{halves:?}");
        // The noise that is left, by the areas, and that of single pixels.
        assert!((width.noise(64, MOST_HALF) / NOISE - 1.0).abs() < 0.01, "{}", width.noise(64, MOST_HALF));
        assert!((width.noise(50, 0.0) / (2.0_f64 / 50.0).sqrt() - 1.0).abs() < 1e-9);
        assert_eq!(Width::for_noise(1e3).of_sample(0), MOST_HALF);
        assert!(Width::for_noise(0.0).is_none());
    }
}
