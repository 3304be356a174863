//! Spreads the light of rays over their footprints as they land: each ray's integers in shares that add up to them.

use crate::footprint::{Box, Footprint, Ground, MOST_HALF, shared};
use crate::pipeline::{Pipeline, ThreadState};
use crate::sums::{ExactSums, OwnSteps};
use crate::veil;
use spectra_core::batch::pixel_and_channel;
use std::sync::Arc;

/// How far footprints reach to each side at most in frames so large that each pixel's share is added by itself: as many additions as a
/// ray's path takes time for.
const LARGE_FRAME_HALF: f64 = 2.0;

/// The frame of a scene, ready for light to be spread over it.
#[derive(Clone, Debug)]
pub(crate) struct Spreader {
    ground: Ground,
    /// Columns and rows of the frame, and channels.
    frame: [usize; 2],
    channels: usize,
    /// How far footprints reach to each side at most, pixels.
    pub most_half: f64,
    /// Of a mosaic the channel of each pixel, by its place among those recorded.
    filters: Option<Arc<[u8]>>,
}

impl Spreader {
    /// For the frame and the recorded channels of a scene.
    pub fn of(pipeline: &Pipeline) -> Self {
        let size = pipeline.scene.imager.size();
        let frame = [size.width_px, size.height_px].map(|side| side as usize);
        let channels = pipeline.recorded.len();
        let most_half = if OwnSteps::suit(frame, channels) { MOST_HALF } else { LARGE_FRAME_HALF };
        let ground = Ground::new(size.width_px, size.height_px);
        Self { ground, frame, channels, most_half, filters: filters(pipeline) }
    }

    /// Sums of a thread for such shares; `None` where shares are added to those of all threads one by one.
    pub fn steps(&self) -> Option<OwnSteps> {
        OwnSteps::new(self.frame, self.channels, self.filters.clone())
    }

    /// Adds the integers of a batch's rays to the cells that begin with the first, and to those that begin with `own_cells`, each spread over
    /// the footprint that `footprint` gives for the ray's number in the batch.
    #[inline]
    pub fn add(
        &self,
        state: &mut ThreadState,
        footprint: impl Fn(usize) -> Footprint,
        own_cells: Option<usize>,
        sums: &ExactSums,
    ) {
        let ThreadState { rays, integers, steps, .. } = state;
        let (mut shares, mut left) = (vec![0; integers.len()], vec![0; integers.len()]);
        for (i, tag) in rays.tags().iter().enumerate() {
            let pixel = pixel_and_channel(*tag).0;
            let most = integers.iter().map(|integers| integers[i].unsigned_abs()).max().unwrap_or(0);
            if most == 0 {
                continue;
            }
            let footprint = footprint(i);
            let pixels = footprint.pixels();
            for ((share, left), integers) in shares.iter_mut().zip(&mut left).zip(integers.iter()) {
                (*share, *left) = shared(integers[i], pixels);
            }
            match steps {
                Some(own) => {
                    own.make_room(most, sums);
                    self.ground.each_box(pixel, &footprint, |pixels| own.add_box(pixels, &shares));
                    if pixels > 1 {
                        own.add_rest(pixel as usize, &left);
                    }
                }
                None => self.each(pixel, &footprint, [&shares, &left], sums, 0),
            }
            if let Some(first) = own_cells {
                self.each(pixel, &footprint, [&shares, &left], sums, first);
            }
        }
    }

    /// Adds shares of a footprint, and what is left to the pixel in its middle, to the sums of all threads, in the cells that begin with
    /// `first`.
    fn each(&self, pixel: u32, footprint: &Footprint, [shares, left]: [&[i64]; 2], sums: &ExactSums, first: usize) {
        let filters = self.filters.as_deref();
        let add = |[columns, [low, high]]: Box, values: &[i64]| {
            for row in low..=high {
                let [from, to] = columns.map(|column| self.ground.pixel(column, row));
                for pixel in from..=to {
                    let only = filters.map(|filters| filters[pixel] as usize);
                    let cell = first + pixel * values.len();
                    match only {
                        None => (cell..).zip(values).for_each(|(cell, value)| sums.add(cell, *value)),
                        Some(only) => sums.add(cell + only, values[only]),
                    }
                }
            }
        };
        self.ground.each_box(pixel, footprint, |pixels| add(pixels, shares));
        add(self.ground.one(pixel), left);
    }
}

/// Of a mosaic the channel of each pixel.
fn filters(pipeline: &Pipeline) -> Option<Arc<[u8]>> {
    let only = veil::filters(pipeline)?;
    let channel = |only: u8| pipeline.recorded.iter().position(|at| *at == only as usize).unwrap_or(0) as u8;
    Some(only.into_iter().map(channel).collect())
}
