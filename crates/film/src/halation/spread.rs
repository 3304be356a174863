//! Convolution over the levels: cells are averaged on the way down and interpolated on the way up.

use super::kernel::{Level, STEP};
use crate::convolve::Convolver;
use crate::raster::Raster;
use rayon::prelude::*;

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
        // Averages, finest first.
        let mut coarse: Vec<Cells> = Vec::new();
        for (cell_px, _) in self.levels.iter().filter(|(cell, _)| *cell > 1) {
            let next = match coarse.last() {
                Some(finer) => finer.averaged(self.width, self.height),
                None => Cells::averaged_pixels(&source, self.width, self.height, *cell_px),
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
                convolver.apply(&cells.values, &mut spread, |to, v| *to = v.max(0.0) as f32);
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
    /// Means of the pixels that each cell covers; beside the frame there is no light.
    fn averaged_pixels(plane: &[f32], width: usize, height: usize, cell_px: usize) -> Self {
        let (w, h) = (with_margin(width, cell_px), with_margin(height, cell_px));
        let mut values = vec![0.0_f32; w * h];
        let area = (cell_px * cell_px) as f64;
        values.par_chunks_mut(w).enumerate().for_each(|(row, line)| {
            let Some(y) = row.checked_sub(MARGIN).map(|r| r * cell_px).filter(|y| *y < height) else { return };
            let mut sums = vec![0.0_f64; w];
            for line in plane[y * width..(y + cell_px).min(height) * width].chunks_exact(width) {
                for (sum, cell) in sums[MARGIN..].iter_mut().zip(line.chunks(cell_px)) {
                    *sum += cell.iter().filter(|v| v.is_finite()).map(|v| f64::from(*v)).sum::<f64>();
                }
            }
            line.iter_mut().zip(sums).for_each(|(to, sum)| *to = (sum / area) as f32);
        });
        Self { cell_px, width: w, values }
    }

    /// The next coarser level of a frame of `width` by `height` pixels.
    fn averaged(&self, width: usize, height: usize) -> Self {
        let (w, h) = (width.div_ceil(self.cell_px), height.div_ceil(self.cell_px));
        let inner = (0..h).flat_map(|j| {
            let from = (j + MARGIN) * self.width + MARGIN;
            self.values[from..from + w].iter().copied()
        });
        let next = Self::averaged_pixels(&inner.collect::<Vec<f32>>(), w, h, STEP);
        Self { cell_px: self.cell_px * STEP, ..next }
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
