//! Convolution over the levels: light is shared out to coarser cells on the way down, interpolated on the way up.

use super::kernel::{Level, STEP};
use crate::raster::Raster;
use rayon::prelude::*;
use spectra_numerics::convolve::Convolver;

/// Cells beside the frame that a coarse level computes, so that there is something to interpolate with at its border.
pub(super) const MARGIN: usize = 2;

/// A sum of convolutions.
pub(super) struct Spread {
    width: usize,
    height: usize,
    /// Light that stays in its pixel.
    stays: f32,
    levels: Vec<(usize, Convolver)>,
}

/// A plane of cells, with [`MARGIN`] around the frame.
struct Cells {
    cell_px: usize,
    width: usize,
    values: Vec<f32>,
}

fn with_margin(pixels: usize, cell_px: usize) -> usize {
    pixels.div_ceil(cell_px) + 2 * MARGIN
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
        let source = plane.to_vec();
        // Finest first.
        let mut coarse: Vec<Cells> = Vec::new();
        let frame = [self.width, self.height];
        for (cell_px, _) in self.levels.iter().filter(|(cell, _)| *cell > 1) {
            let next = match coarse.last() {
                Some(f) => Cells::gathered(&f.values, f.width, MARGIN, frame, f.cell_px, STEP),
                None => Cells::gathered(&source, self.width, 0, frame, 1, *cell_px),
            };
            coarse.push(next);
        }
        let mut above: Option<Cells> = None;
        for (cell_px, convolver) in self.levels.iter().rev() {
            if *cell_px == 1 {
                convolver.apply(&source, plane, |to, v| *to = v.max(0.0) as f32);
                break;
            }
            if let Some(cells) = coarse.pop() {
                let mut spread = vec![0.0; cells.values.len()];
                convolver.apply(&cells.values, &mut spread, |to, v| *to = v as f32);
                let mut now = Cells { values: spread, ..cells };
                if let Some(above) = above.take() {
                    above.add_to_cells(&mut now);
                }
                above = Some(now);
            }
        }
        if self.levels.iter().all(|(cell, _)| *cell > 1) {
            // Even the ring is on coarse cells: the pixels have what stays.
            plane.par_iter_mut().for_each(|v| *v = if v.is_finite() { *v * self.stays } else { 0.0 });
        }
        let Some(above) = above else { return };
        above.add_to_pixels(plane, self.width);
    }
}

impl Cells {
    /// The light of finer cells (or pixels, without margin) shared out to the cells around each, linearly by distance, so
    /// that its sum and its center of gravity stay; for a frame of `frame` pixels.
    fn gathered(
        fine: &[f32],
        fine_width: usize,
        margin: usize,
        frame: [usize; 2],
        fine_px: usize,
        step: usize,
    ) -> Self {
        let cell_px = fine_px * step;
        let (width, height) = (with_margin(frame[0], cell_px), with_margin(frame[1], cell_px));
        let fine_height = fine.len() / fine_width;
        let center = |k: usize| (k as f64 + 0.5 - margin as f64) / step as f64;
        let columns: Vec<_> = (0..fine_width).map(|k| Self::place(center(k))).collect();
        let rows: Vec<_> = (0..fine_height).map(|k| Self::place(center(k))).collect();
        let area = (step * step) as f64;
        let mut values = vec![0.0_f32; width * height];
        values.par_chunks_mut(width).enumerate().for_each(|(row, line)| {
            // Rows that share with this one lie next to each other.
            let begin = rows.partition_point(|(j, _)| j + 1 < row);
            let end = rows.partition_point(|(j, _)| *j <= row);
            let mut sums = vec![0.0_f64; fine_width];
            for k in begin..end {
                let (j, part) = rows[k];
                let weight = if j == row { 1.0 - part } else { part };
                for (sum, v) in sums.iter_mut().zip(&fine[k * fine_width..(k + 1) * fine_width]) {
                    *sum += if v.is_finite() { f64::from(weight) * f64::from(*v) } else { 0.0 };
                }
            }
            let mut cells = vec![0.0_f64; width];
            for (sum, (i, part)) in sums.iter().zip(&columns) {
                cells[*i] += sum * (1.0 - f64::from(*part));
                cells[i + 1] += sum * f64::from(*part);
            }
            line.iter_mut().zip(cells).for_each(|(to, v)| *to = (v / area) as f32);
        });
        Self { cell_px, width, values }
    }

    /// The column or row left of the place `x` (center of a pixel or cell, in units of these cells from the frame's
    /// border), and the part of its neighbor.
    fn place(x: f64) -> (usize, f32) {
        let p = x - 0.5 + MARGIN as f64;
        let k = p.floor();
        (k as usize, (p - k) as f32)
    }

    /// Adds these cells, linear between their centers, to one line of what is finer.
    fn add_line(&self, y: f64, columns: &[(usize, f32)], line: &mut [f32]) {
        let (j, v) = Self::place(y);
        let (upper, lower) = (&self.values[j * self.width..][..self.width], &self.values[(j + 1) * self.width..]);
        for (to, (i, u)) in line.iter_mut().zip(columns) {
            let a = upper[*i] + (lower[*i] - upper[*i]) * v;
            let b = upper[i + 1] + (lower[i + 1] - upper[i + 1]) * v;
            *to += a + (b - a) * u;
        }
    }

    fn add_to_pixels(&self, plane: &mut [f32], width: usize) {
        let per_cell = 1.0 / self.cell_px as f64;
        let columns: Vec<_> = (0..width).map(|i| Self::place((i as f64 + 0.5) * per_cell)).collect();
        plane.par_chunks_mut(width).enumerate().for_each(|(row, line)| {
            self.add_line((row as f64 + 0.5) * per_cell, &columns, line);
        });
    }

    /// Adds these cells to those of the next finer level, its margin included.
    fn add_to_cells(&self, finer: &mut Self) {
        let center = |k: usize| (k as f64 + 0.5 - MARGIN as f64) / STEP as f64;
        let columns: Vec<_> = (0..finer.width).map(|i| Self::place(center(i))).collect();
        let width = finer.width;
        finer.values.par_chunks_mut(width).enumerate().for_each(|(row, line)| {
            self.add_line(center(row), &columns, line);
        });
    }
}
