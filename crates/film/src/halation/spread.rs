//! Convolution over the levels: light is shared out to coarser cells on the way down, interpolated on the way up.

use super::kernel::{Level, STEP};
use crate::cells::{Cells, with_margin};
use crate::raster::Raster;
use spectra_numerics::convolve::Convolver;

/// A sum of convolutions.
pub(super) struct Spread {
    width: usize,
    height: usize,
    /// Light that stays in its pixel.
    stays: f32,
    levels: Vec<(usize, Convolver)>,
}

impl Spread {
    pub(super) fn new(levels: Vec<Level>, stays: f64, raster: &Raster) -> Self {
        let (width, height) = (raster.width, raster.height);
        let prepare = |level: Level| {
            let cell = level.cell_px;
            let (w, h) =
                if cell == 1 { (width, height) } else { (with_margin(width, cell), with_margin(height, cell)) };
            (cell, Convolver::new(&level.kernel, w, h))
        };
        let stays = stays as f32;
        Self { width, height, stays, levels: levels.into_iter().map(prepare).collect() }
    }

    pub(super) fn apply(&self, plane: &mut [f32]) {
        // Finest first.
        let mut coarse: Vec<Cells> = Vec::new();
        let frame = [self.width, self.height];
        for (cell_px, _) in self.levels.iter().filter(|(cell, _)| *cell > 1) {
            coarse.push(match coarse.last() {
                Some(finer) => finer.gathered(frame, STEP),
                None => Cells::of_pixels(plane, frame, *cell_px, |v| v),
            });
        }
        let mut above: Option<Cells> = None;
        for (_, convolver) in self.levels.iter().rev().filter(|(cell, _)| *cell > 1) {
            if let Some(mut now) = coarse.pop() {
                now.convolve(convolver);
                if let Some(above) = above.take() {
                    above.add_to_cells(&mut now, STEP);
                }
                above = Some(now);
            }
        }
        match self.levels.first() {
            Some((1, convolver)) => {
                let source = plane.to_vec();
                convolver.apply(&source, plane, |to, v| *to = v.max(0.0) as f32);
                if let Some(above) = above {
                    above.over_pixels(plane, self.width, |to, v| *to += v);
                }
            }
            // Even the ring is on coarse cells: the pixels have what stays.
            _ => {
                let stays = self.stays;
                let lit = |v: f32| if v.is_finite() { v * stays } else { 0.0 };
                if let Some(above) = above {
                    above.over_pixels(plane, self.width, |to, v| *to = (lit(*to) + v).max(0.0));
                }
            }
        }
    }
}
