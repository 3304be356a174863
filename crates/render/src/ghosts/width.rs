//! Finds how wide footprints have to be, from the noise of ghosts if each ray adds to one pixel only.
//!
//! The area of a footprint is chosen for a noise of 2.1 % after 64 samples; it reaches at most 14 pixels to each side. The area falls with
//! the root of the sample's number, not with how many samples will follow. Noise and blur both tend to zero, and light that is continued
//! has the bits of light in one go.

use super::{Ghosts, SCALE_RAYS, spans};
use crate::Workers;
use crate::error::RenderError;
use crate::footprint::MOST_HALF;
use crate::pipeline::ThreadState;
use spectra_core::batch::pixel_and_channel;
use spectra_core::workers::map_pieces;

/// Noise of a pixel that footprints are to leave after [`SAMPLES`] samples, as a fraction of the light. Neighboring pixels share most of
/// it: about the plane fitted to 16 x 16 pixels, roughly six tenths remain.
const NOISE: f64 = 0.021;
/// Number of samples for which the noise is specified.
const SAMPLES: f64 = 64.0;
/// Factor on the total variance, because earlier samples have larger footprints.
const EARLIER: f64 = 2.0 / 3.0;
/// Number of parts across the frame in which noise is measured.
const ACROSS: usize = 20;
/// Smallest number of rays in a part that is taken into account.
const LEAST: f64 = 6.0;

/// The half side of footprints, pixels, sample by sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Width {
    /// Side of footprints at sample number [`SAMPLES`]; 0 if there is no noise.
    side: f64,
}

impl Width {
    /// Computes the width from the noise of a pixel in a picture of one sample: variance over the square of the mean.
    fn for_noise(variance: f64) -> Self {
        let pixels = EARLIER * variance / SAMPLES / (NOISE * NOISE);
        Self { side: pixels.sqrt() }
    }

    /// Returns the half side of footprints in a sample. Their area falls with the square root of the sample's number, so that both noise
    /// and blur tend to zero. It does not depend on how many samples follow, so a render that is continued gets the same bits as one
    /// without a stop.
    pub fn of_sample(&self, sample: u64) -> f64 {
        (0.5 * (self.side * (SAMPLES / (sample + 1) as f64).sqrt().sqrt() - 1.0)).clamp(0.0, MOST_HALF)
    }

    /// Returns the noise that is left in a pixel, as a fraction of its light, after this many samples whose footprints reach no farther
    /// than `most_half` to each side.
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

/// The contribution of a ray: the cell of a part of the frame and a channel, the value, and the number of rays that it stands for.
type CellContribution = (u32, f64, f64);

/// Finds the width for ghosts whose rays are already shared out.
pub(super) fn found(ghosts: &Ghosts, workers: &dyn Workers) -> Result<Width, RenderError> {
    let size = ghosts.pipeline.scene.imager.size();
    let (width, height) = (size.width_px as usize, size.height_px as usize);
    let side = width.max(height).div_ceil(ACROSS);
    let across = width.div_ceil(side);
    let channels = ghosts.pipeline.responses.channels();
    let part_of = |pixel: usize| pixel / width / side * across + pixel % width / side;
    let each = map_pieces(
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

/// Returns the contributions of a block's rays of one path.
fn parts(ghosts: &Ghosts, state: &mut ThreadState, at: usize, first: impl Fn(usize) -> usize) -> Vec<CellContribution> {
    let all = ghosts.plan.ways[at].rays;
    let some = all.min(SCALE_RAYS);
    let stands_for = all as f64 / some as f64;
    let channels = ghosts.pipeline.responses.channels();
    let mut parts = Vec::new();
    for span in spans(0..some, state.rays.capacity()) {
        ghosts.batch(state, at, span, |_, _| {});
        let brought = ghosts.contributions(state);
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
        // The noise that is left, from the areas, and that of single pixels.
        assert!((width.noise(64, MOST_HALF) / NOISE - 1.0).abs() < 0.01, "{}", width.noise(64, MOST_HALF));
        assert!((width.noise(50, 0.0) / (2.0_f64 / 50.0).sqrt() - 1.0).abs() < 1e-9);
        assert_eq!(Width::for_noise(1e3).of_sample(0), MOST_HALF);
        assert!(Width::for_noise(0.0).is_none());
    }
}
