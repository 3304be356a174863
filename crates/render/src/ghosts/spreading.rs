//! Light of ghosts as it lands: each ray's integers in shares that add up to them, over the pixels of its footprint.

use super::footprint::{Box, Footprint, Ground, MOST_HALF, shared};
use super::probes::{self, Found};
use super::width::{self, Width};
use super::{Ghosts, Landed};
use crate::error::RenderError;
use crate::pipeline::{Pipeline, ThreadState};
use crate::sums::{ExactSums, OwnSteps};
use crate::{Workers, veil};
use spectra_core::batch::pixel_and_channel;
use std::sync::Arc;

/// How far footprints reach to each side at most in frames so large that each pixel's share is added by itself: as many additions as a
/// ray's path takes time for.
const LARGE_FRAME_HALF: f64 = 2.0;

/// What spreading needs, found once for a scene.
#[derive(Clone, Debug)]
pub(super) struct Spreading {
    ground: Ground,
    width: Width,
    /// How far footprints reach to each side at most.
    most_half: f64,
    /// Of each path by the zones of the source.
    nets: Vec<Vec<Found>>,
    /// Of a mosaic the channel of each pixel, by its place among those recorded.
    filters: Option<Arc<[u8]>>,
}

impl Spreading {
    /// For ghosts whose rays are shared out already; `None` where there is nothing to spread.
    pub fn of(ghosts: &Ghosts, workers: &dyn Workers) -> Result<Option<Self>, RenderError> {
        let width = width::found(ghosts, workers)?;
        if width.is_none() {
            return Ok(None);
        }
        let size = ghosts.pipeline.scene.imager.size();
        let (nets, filters) = (probes::nets(ghosts, workers)?, filters(&ghosts.pipeline));
        let is_small = OwnSteps::suit(frame(ghosts), ghosts.pipeline.recorded.len());
        let most_half = if is_small { MOST_HALF } else { LARGE_FRAME_HALF };
        Ok(Some(Self { ground: Ground::new(size.width_px, size.height_px), width, most_half, nets, filters }))
    }

    /// Sums of a thread for such shares; `None` where shares are added to those of all threads one by one.
    pub fn steps(&self, ghosts: &Ghosts) -> Option<OwnSteps> {
        OwnSteps::new(frame(ghosts), ghosts.pipeline.recorded.len(), self.filters.clone())
    }

    /// Adds what the rays of a batch of a path bring, in a sample of this number, to the cells of all paths and to those that begin with
    /// `own_cells`.
    pub fn add(
        &self,
        state: &mut ThreadState,
        (at, sample): (usize, u64),
        landed: &[Landed],
        own_cells: Option<usize>,
        sums: &ExactSums,
    ) {
        let half = self.width.of_sample(sample).min(self.most_half);
        let ThreadState { rays, integers, steps, .. } = state;
        let (mut shares, mut left) = (vec![0; integers.len()], vec![0; integers.len()]);
        for (i, (tag, landed)) in rays.tags().iter().zip(landed).enumerate() {
            let pixel = pixel_and_channel(*tag).0;
            let footprint =
                self.nets[at].get(landed.zone).map_or(Footprint::PIXEL, |found| found.footprint(landed, half));
            let pixels = footprint.pixels();
            let mut most = 0;
            for ((share, left), integers) in shares.iter_mut().zip(&mut left).zip(integers.iter()) {
                (*share, *left) = shared(integers[i], pixels);
                most = most.max(integers[i].unsigned_abs());
            }
            if most == 0 {
                continue;
            }
            match steps {
                Some(own) => {
                    own.make_room(most, sums);
                    self.ground.each_box(pixel, &footprint, |pixels| own.add_box(pixels, &shares));
                    own.add_box(self.ground.one(pixel), &left);
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

/// Columns and rows of the frame.
fn frame(ghosts: &Ghosts) -> [usize; 2] {
    let size = ghosts.pipeline.scene.imager.size();
    [size.width_px, size.height_px].map(|side| side as usize)
}

/// Of a mosaic the channel of each pixel.
fn filters(pipeline: &Pipeline) -> Option<Arc<[u8]>> {
    let only = veil::filters(pipeline)?;
    let channel = |only: u8| pipeline.recorded.iter().position(|at| *at == only as usize).unwrap_or(0) as u8;
    Some(only.into_iter().map(channel).collect())
}
