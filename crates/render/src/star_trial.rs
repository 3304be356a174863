//! Decides before light is traced whether the stars of lamps are bright enough to be seen.
//!
//! Diffraction at the edge of the aperture takes seconds. Unless the scene decides, it is on if lights are rendered apart from the rest and
//! the star of the brightest pixel exceeds 1 % of the frame's median in some channel, at the distance where it leaves the core. The sums of
//! a render that was stopped cannot tell that, so a trial does: it gives the median of the rest ([`crate::trial`]), and up to 262 144 rays of
//! the lights give the brightest pixel. Where these are few for each pixel, a square of pixels around it takes its place, large enough to
//! hold 64 rays. The trial draws from the random numbers of the pilot, so every seed of the picture decides alike.

use crate::estimator::Estimator;
use crate::pilot::PILOT_SEED;
use crate::pipeline::Pipeline;
use crate::trial::{medians, new_sums, of_pilot};
use crate::{Done, RenderError, diffracted};
use spectra_core::frame::FrameSize;

/// Fraction of the median of the frame above which a star is seen.
const SEEN: f64 = crate::ghosts::MATTERS;
/// Largest number of rays of the lights, unless one unit of work has more.
const LIGHT_RAYS: u64 = 1 << 18;
/// Smallest number of rays from which the brightest place is known: to an eighth.
const ENOUGH: f64 = 64.0;
/// Largest side of the square that takes the place of the brightest pixel.
const LARGEST_SQUARE: usize = 64;

/// Returns whether the star of the brightest pixel can be seen, from the estimators of the rest and of the lights.
pub(crate) fn is_star_seen(
    pipeline: &Pipeline,
    rest: &dyn Estimator,
    lights: &dyn Estimator,
) -> Result<bool, RenderError> {
    let (medians, peaks) = (medians(pipeline, rest)?, peaks(pipeline, lights)?);
    let star = |(channel, (median, peak)): (&usize, (f64, f64))| {
        Some(diffracted::star_of_pixel(&pipeline.scene, *channel)? * (median + peak) / median)
    };
    let stars = pipeline.recorded.iter().zip(medians.into_iter().zip(peaks)).filter_map(star);
    // Without any light around it, a star is always seen.
    Ok(stars.filter(|star| !star.is_nan()).fold(0.0, f64::max) > SEEN)
}

/// Returns the light of the brightest pixel in each channel, W/m2.
fn peaks(pipeline: &Pipeline, lights: &dyn Estimator) -> Result<Vec<f64>, RenderError> {
    let trial = lights.reseeded(&of_pilot(pipeline), PILOT_SEED);
    let most = u64::from(pipeline.scene.render.samples);
    let mut samples = 0..1;
    while trial.rays(&samples, &[0]) < LIGHT_RAYS && samples.end < most {
        samples.end *= 2;
    }
    let (sums, mut scratch) = (new_sums(pipeline)?, trial.scratch());
    let mut rays = 0;
    for unit in 0..trial.units(&samples, &[0]) {
        if rays >= LIGHT_RAYS {
            break;
        }
        rays += trial.run(&samples, &[0], unit, &mut scratch, &sums).rays;
    }
    scratch.finish(&sums);
    let (size, channels) = (pipeline.scene.imager.size(), pipeline.recorded.len());
    let (weights, landed) = (trial.weights(&[&Done::default()], rays, 1.0), scratch.0.detected);
    let peak = |channel| {
        let plane: Vec<f64> =
            weights.iter().enumerate().map(|(pixel, w)| sums.get(pixel * channels + channel) as f64 * w).collect();
        peak(size, plane, landed)
    };
    Ok((0..channels).map(peak).collect())
}

/// Returns the value of the brightest pixel of a plane to which this many rays contributed, or the mean of the brightest square around it.
fn peak(size: FrameSize, mut plane: Vec<f64>, rays: u64) -> f64 {
    let a_ray = plane.iter().sum::<f64>() / rays.max(1) as f64;
    let (mut width, mut height) = (size.width_px as usize, size.height_px as usize);
    let mut side = 1;
    loop {
        let brightest = plane.iter().copied().fold(0.0, f64::max);
        if brightest >= ENOUGH * a_ray || side >= LARGEST_SQUARE || width * height == 1 {
            return brightest / (side * side) as f64;
        }
        // Each square becomes one of four.
        let (across, down) = (width.div_ceil(2), height.div_ceil(2));
        let mut coarse = vec![0.0; across * down];
        for (at, value) in plane.iter().enumerate() {
            coarse[at / width / 2 * across + at % width / 2] += value;
        }
        (plane, width, height, side) = (coarse, across, down, 2 * side);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: FrameSize = FrameSize { width_px: 64, height_px: 48, width_mm: 36.0, height_mm: 24.0 };

    /// A pixel that all rays reach is known at once; a plane with a ray in every tenth pixel is as bright as its mean over a square.
    #[test]
    fn brightest_place_holds_enough_rays() {
        let mut plane = vec![0.0; 64 * 48];
        plane[100] = 3.0;
        assert_eq!(peak(SIZE, plane, 1000), 3.0);
        let sparse: Vec<f64> = (0..64 * 48).map(|at| f64::from(u8::from((at * 7 + at / 64) % 10 == 0))).collect();
        let rays = sparse.iter().sum::<f64>() as u64;
        let found = peak(SIZE, sparse, rays);
        assert!((0.09..0.14).contains(&found), "{found}");
    }
}
