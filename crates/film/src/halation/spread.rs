//! Convolves over the levels: shares light out to coarser cells on the way down, and interpolates on the way up.

use super::kernel::{Level, STEP};
use crate::cells::{Cells, with_margin};
use crate::raster::Raster;
use rayon::prelude::*;
use spectra_numerics::convolve::Convolver;

/// A sum of convolutions, one per level.
pub(super) struct Spread {
    width: usize,
    height: usize,
    /// Fraction of the light that stays in its pixel.
    stays: f32,
    levels: Vec<(usize, Convolver<f32>)>,
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

    /// Spreads the light of `source` and writes it to `plane`.
    pub(super) fn apply(&self, source: &[f32], plane: &mut [f32]) {
        // Finest first.
        let mut coarse: Vec<Cells> = Vec::new();
        let frame = [self.width, self.height];
        for (cell_px, _) in self.levels.iter().filter(|(cell, _)| *cell > 1) {
            coarse.push(match coarse.last() {
                Some(finer) => finer.gathered(frame, STEP),
                None => Cells::of_pixels(source, frame, *cell_px, |v| v),
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
        // If even the ring is on coarse cells, the pixels themselves get only the light that stays.
        if let Some((1, convolver)) = self.levels.first() {
            convolver.apply(source, plane, |to, v| *to = v);
        }
        let rows = plane.par_chunks_mut(self.width).zip(source.par_chunks(self.width)).enumerate();
        let columns = above.as_ref().map(|above| above.columns(self.width));
        rows.for_each(|(row, (to, from))| {
            if let (Some(above), Some(columns)) = (&above, &columns) {
                above.over_row(row, columns, to, |to, v| *to += v);
            }
            for (to, from) in to.iter_mut().zip(from) {
                let stays = if from.is_finite() { from * self.stays } else { 0.0 };
                *to = (*to + stays).max(0.0);
            }
        });
    }
}
