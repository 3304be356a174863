//! Spreads the light of rays over their footprints as they land: divides each ray's integers into shares that add up to them.
//!
//! Each thread keeps the differences between neighboring pixels along rows and columns, so a square costs four additions per channel,
//! however large it is. Frames of more than 2.8 million pixels of three channels have no room for that. There the share of each pixel is
//! added separately, so squares reach at most 2 pixels to each side. Separate layers of single paths cost as much time again.

use crate::footprint::{Footprint, FrameGrid, MOST_HALF, PixelBox, shared};
use crate::pipeline::{Pipeline, ThreadState};
use crate::sums::{ExactSums, OwnSteps};
use crate::veil;
use spectra_core::batch::pixel_and_channel;
use std::sync::Arc;

/// Largest half side of footprints, pixels, in frames so large that the share of each pixel is added separately. So many additions take
/// about as long as tracing the ray.
const LARGE_FRAME_HALF: f64 = 2.0;

/// The frame of a scene, prepared for spreading light over it.
#[derive(Clone, Debug)]
pub(crate) struct Spreader {
    ground: FrameGrid,
    /// Number of columns and rows of the frame.
    frame: [usize; 2],
    channels: usize,
    /// Largest half side of footprints, pixels.
    pub most_half: f64,
    /// The channel of each pixel of a mosaic, as its position among the recorded ones; `None` if pixels have all channels.
    filters: Option<Arc<[u8]>>,
}

impl Spreader {
    /// Prepares spreading for the frame and the recorded channels of a scene.
    pub fn of(pipeline: &Pipeline) -> Self {
        let size = pipeline.scene.imager.size();
        let frame = [size.width_px, size.height_px].map(|side| side as usize);
        let channels = pipeline.recorded.len();
        let most_half = if OwnSteps::suit(frame, channels) { MOST_HALF } else { LARGE_FRAME_HALF };
        let ground = FrameGrid::new(size.width_px, size.height_px);
        Self { ground, frame, channels, most_half, filters: filters(pipeline) }
    }

    /// Allocates sums of one thread for spread shares; `None` if shares are added to the shared sums one by one.
    pub fn steps(&self) -> Option<OwnSteps> {
        OwnSteps::new(self.frame, self.channels, self.filters.clone())
    }

    /// Spreads the fixed-point contributions of a batch's rays over their footprints and adds them to the sums. `footprint`
    /// returns the footprint of the ray with this index in the batch. If `own_cells` is given, the contributions are also added
    /// to the separate cells that begin there.
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

    /// Adds the shares of a footprint to the shared sums, and the rest to the pixel in its middle. The cells begin at `first`.
    fn each(&self, pixel: u32, footprint: &Footprint, [shares, left]: [&[i64]; 2], sums: &ExactSums, first: usize) {
        let filters = self.filters.as_deref();
        let add = |[columns, [low, high]]: PixelBox, values: &[i64]| {
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

/// Returns the channel of each pixel of a mosaic, as its position among the recorded ones; `None` if pixels have all channels.
fn filters(pipeline: &Pipeline) -> Option<Arc<[u8]>> {
    let only = veil::filters(pipeline)?;
    let channel = |only: u8| pipeline.recorded.iter().position(|at| *at == only as usize).unwrap_or(0) as u8;
    Some(only.into_iter().map(channel).collect())
}
