//! Traces what the camera's meter sees, with rays of its own, so that metering does not change the picture's samples.
//!
//! The meter measures everything that falls on the film, ghosts and veiling glare included. It needs a mean, not a picture, so it gets a
//! small fraction of the rays, some 4 % of a picture of 64 samples. They are drawn from a wavelength density made for its own channel, with
//! separate random numbers. If there are fewer rays than pixels that it looks at, neighboring pixels share one.
//!
//! If a film meters, light is recorded for 1 s, and the result is scaled to the time that the meter finds (`Scene::film_times`).

use crate::Workers;
use crate::error::RenderError;
use crate::finite_check::FiniteCheck;
use crate::non_finite::Step;
use crate::pipeline::{Pipeline, ThreadState};
use crate::sums::ExactSums;
use spectra_core::batch::pixel_and_channel;
use spectra_core::numbers::Numbers;
use spectra_core::workers::map_pieces;
use spectra_core::{Isa, RayBatch};
use spectra_optics::Effort;
use std::ops::Range;

/// Rays of a meter per pixel: 4 % of the time of a picture of 64 samples. They do not depend on the picture's own number of samples, so
/// that a picture traced step by step is metered like one traced at once.
const RAYS_PER_PIXEL: f64 = 64.0 / 25.0;
/// Smallest number of rays of a meter: the mean of a frame of usual contrast is then within half a percent (1/140 stop).
const LEAST: u64 = 1 << 16;
/// Largest number of rays of a meter; more do not improve the mean noticeably.
const MOST: u64 = 1 << 20;
/// Number of rays of a meter for a draft: the mean is within 1 %.
const OF_DRAFT: u64 = 1 << 14;
/// Largest number of rays of a forward meter, which needs many to hit a small spot.
const MOST_FORWARD: u64 = 1 << 22;
/// Places in a unit of work. They share one stream of random numbers, so that neighbors complete each other.
const PLACES_PER_UNIT: usize = 64;
/// Turns the picture's seed into the meter's.
pub(crate) const SEED: u64 = 0x6d65_7465_7220_6c78;
/// Stream of the random numbers that choose a pixel among neighbors.
const CHOICE: u64 = u64::MAX;

/// Traces rays from the pixels that its third argument writes, and passes them to its fourth argument after each step.
type Follow<'a> =
    dyn Fn(&mut ThreadState, usize, &mut dyn FnMut(&mut RayBatch), &mut dyn FnMut(Step, &RayBatch)) + Sync + 'a;
/// Traces a number of rays, given by the first ray and their count, and adds their light to the sums.
type SumUp<'a> = dyn Fn(&mut ThreadState, u64, u64, &ExactSums) -> Option<RenderError> + Sync + 'a;

/// Returns the number of rays that a meter takes in a frame of this many pixels.
pub(crate) fn rays_for(pixels: usize, effort: Effort) -> u64 {
    match effort {
        Effort::Full => ((pixels as f64 * RAYS_PER_PIXEL) as u64).clamp(LEAST, MOST),
        Effort::Draft => OF_DRAFT,
    }
}

/// A pixel that the meter looks at, for itself and its neighbors.
struct MeterPoint {
    pixel: u32,
    /// Pixels that get the value of this one, as a range of the metered pixels.
    stands_for: Range<usize>,
}

/// Returns at most `most` places that cover `pixels` evenly.
fn places(pixels: &[u32], most: u64, numbers: &Numbers, isa: Isa) -> Vec<MeterPoint> {
    let count = pixels.len().min(most as usize);
    let mut choice = vec![0.0; count];
    numbers.fill(isa, CHOICE, 0, 0, &mut choice);
    let border = |at: usize| (at as u64 * pixels.len() as u64 / count as u64) as usize;
    let place = |(at, u): (usize, f64)| {
        let stands_for = border(at)..border(at + 1);
        let chosen = stands_for.start + (u * stands_for.len() as f64) as usize;
        MeterPoint { pixel: pixels[chosen.min(stands_for.end - 1)], stands_for }
    };
    choice.into_iter().enumerate().map(place).collect()
}

/// Measures the mean irradiance times response of each of the pipeline's channels over the whole frame, W mm^-2 like those of the picture,
/// and 0 where no meter looks. `follow` traces rays from pixels. Stages derive their own random numbers from the estimator name `name`.
pub(crate) fn backward(
    pipeline: &Pipeline,
    (name, follow): (&str, &Follow<'_>),
    workers: &dyn Workers,
) -> Result<Vec<Vec<f64>>, RenderError> {
    let (scene, isa) = (&pipeline.scene, pipeline.isa);
    let pixels = scene.metered_pixels();
    let size = scene.imager.size().pixels();
    let channels = pipeline.responses.channels();
    let mut planes = vec![vec![0.0; size]; channels];
    if pixels.is_empty() {
        return Ok(planes);
    }
    let rays = rays_for(size, pipeline.effort);
    let numbers = Numbers::sobol(pipeline.seed ^ SEED);
    let places = places(&pixels, rays, &numbers, isa);
    let samples = (rays / places.len() as u64).max(1) as usize;
    let units: Vec<&[MeterPoint]> = places.chunks(PLACES_PER_UNIT).collect();
    let work = |state: &mut ThreadState, at: usize| {
        if workers.should_stop() {
            return Err(RenderError::Stopped);
        }
        unit(pipeline, (name, follow), &numbers, state, at as u64, units[at], samples)
    };
    let fresh = || ThreadState::new(pipeline, scene.render.batch);
    let sums = map_pieces(workers, units.len(), fresh, work)?;
    for (place, of_channels) in places.iter().zip(sums.iter().flat_map(|sums| sums.chunks_exact(channels))) {
        for (plane, sum) in planes.iter_mut().zip(of_channels) {
            for pixel in &pixels[place.stands_for.clone()] {
                plane[*pixel as usize] = sum / samples as f64;
            }
        }
    }
    Ok(planes)
}

/// Sums `samples` rays from each place, channel by channel.
fn unit(
    pipeline: &Pipeline,
    (name, follow): (&str, &Follow<'_>),
    numbers: &Numbers,
    state: &mut ThreadState,
    stream: u64,
    places: &[MeterPoint],
    samples: usize,
) -> Result<Vec<f64>, RenderError> {
    let channels = pipeline.responses.channels();
    let mut sums = vec![0.0; places.len() * channels];
    let (all, capacity) = (places.len() * samples, state.rays.capacity());
    for first in (0..all).step_by(capacity) {
        let len = capacity.min(all - first);
        let trace = |state: &mut ThreadState, look: &mut dyn FnMut(Step, &RayBatch)| {
            for (dimension, column) in state.numbers.iter_mut().enumerate() {
                let group = pipeline.group(dimension);
                let out = column.slice_mut(len);
                numbers.fill_rotated(pipeline.isa, stream, first as u64, group, dimension as u32, out);
            }
            let mut start = |rays: &mut RayBatch| {
                let tags = rays.columns_mut().tag.iter_mut();
                tags.zip(first..).for_each(|(tag, at)| *tag = places[at / samples].pixel);
                rays.number(0, numbers, name, stream, first as u64);
            };
            follow(state, len, &mut start, look);
        };
        trace(state, &mut |_, _| {});
        for channel in 0..channels {
            let rays = &state.rays;
            let values = &mut state.values[..rays.len()];
            pipeline.isa.run(pipeline.responses.weigh(channel, rays.wavelengths_nm(), rays.weights(), values));
            // Pixels come in rising order and rays keep their order, so the sums do not depend on the size of a batch.
            for (value, tag) in values.iter().zip(rays.tags()) {
                let (pixel, only) = pixel_and_channel(*tag);
                let at = places.partition_point(|place| place.pixel < pixel);
                if only.is_none_or(|only| only as usize == pipeline.recorded[channel]) {
                    sums[at * channels + channel] += value;
                }
            }
        }
        if sums.iter().any(|sum| !sum.is_finite()) {
            let mut blame = FiniteCheck::default();
            trace(state, &mut |step, rays| blame.look(step, rays));
            return Err(blame.error(pipeline, state, 1.0));
        }
    }
    Ok(sums)
}

/// Measures what the meters see by rays from the source. `unit` traces a span of at most `a_unit` rays and sums their light times `scale`.
pub(crate) fn forward(
    pipeline: &Pipeline,
    scale: f64,
    (a_unit, unit): (u64, &SumUp<'_>),
    workers: &dyn Workers,
) -> Result<Vec<Vec<f64>>, RenderError> {
    let scene = &pipeline.scene;
    let size = scene.imager.size();
    let channels = pipeline.responses.channels();
    let looked_at = scene.metered_pixels().len();
    if looked_at == 0 {
        return Ok(vec![vec![0.0; size.pixels()]; channels]);
    }
    // Rays land at random: take enough to put as many into the metered area as backward ones would.
    let rays = rays_for(size.pixels(), pipeline.effort);
    let rays = (rays as f64 * size.pixels() as f64 / looked_at as f64).min(MOST_FORWARD.max(rays) as f64) as u64;
    let too_large = || RenderError::Memory(crate::memory_needed(scene));
    let sums = ExactSums::new(size.pixels() * channels).ok_or_else(too_large)?;
    let work = |state: &mut ThreadState, at: usize| {
        let first = at as u64 * a_unit;
        if workers.should_stop() {
            return Err(RenderError::Stopped);
        }
        unit(state, first, a_unit.min(rays - first), &sums).map_or(Ok(()), Err)
    };
    let fresh = || ThreadState::new(pipeline, scene.render.batch);
    map_pieces(workers, rays.div_ceil(a_unit) as usize, fresh, work)?;
    let weight = 1.0 / scale / size.pixel_area_mm2() / rays as f64;
    Ok(planes(&sums, channels, |_| weight, size.pixels()))
}

/// Converts sums to one plane per channel. `weight` is the factor of the sums at each pixel.
pub(crate) fn planes(sums: &ExactSums, channels: usize, weight: impl Fn(usize) -> f64, pixels: usize) -> Vec<Vec<f64>> {
    let value = |pixel: usize, channel: usize| sums.get(pixel * channels + channel) as f64 * weight(pixel);
    (0..channels).map(|channel| (0..pixels).map(|pixel| value(pixel, channel)).collect()).collect()
}
