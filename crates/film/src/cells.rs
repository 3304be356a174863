//! Planes of cells that are some pixels wide: what is smooth is computed on them.
//!
//! A value is shared out to the cells around it and interpolated between cells, both linearly by distance. Each spreads it by a sixth of
//! a squared cell along either axis, which a kernel can have taken off beforehand ([`Kernel::sharpened`]).
//!
//! [`Kernel::sharpened`]: spectra_numerics::convolve::Kernel::sharpened

use rayon::prelude::*;
use spectra_numerics::convolve::Convolver;

/// Cells beside the frame, so that there is something to interpolate with at its border.
pub(crate) const MARGIN: usize = 2;

/// Cells of `cell_px` along an axis of `pixels`, [`MARGIN`] included.
pub(crate) fn with_margin(pixels: usize, cell_px: usize) -> usize {
    pixels.div_ceil(cell_px) + 2 * MARGIN
}

/// What spreading by sharing out to cells and interpolating between them takes, as what half of the variance along an axis is over a
/// squared cell.
pub(crate) const BOTH_WAYS: f64 = 1.0 / 6.0;

/// A plane of cells, with [`MARGIN`] around the frame.
pub(crate) struct Cells {
    cell_px: usize,
    width: usize,
    values: Vec<f32>,
}

impl Cells {
    /// The mean of `value` of a frame's pixels, shared out to cells of `cell_px` pixels so that the sum and the center of gravity stay.
    /// What is no number is 0.
    pub(crate) fn of_pixels(
        plane: &[f32],
        frame: [usize; 2],
        cell_px: usize,
        value: impl Fn(f32) -> f32 + Sync,
    ) -> Self {
        Self::shared(plane, frame[0], 0, frame, [1, cell_px], value)
    }

    /// The same of these cells, which belong to a frame of `frame` pixels, to cells `step` times as wide.
    pub(crate) fn gathered(&self, frame: [usize; 2], step: usize) -> Self {
        Self::shared(&self.values, self.width, MARGIN, frame, [self.cell_px, step], |v| v)
    }

    fn shared(
        fine: &[f32],
        fine_width: usize,
        margin: usize,
        frame: [usize; 2],
        [fine_px, step]: [usize; 2],
        value: impl Fn(f32) -> f32 + Sync,
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
                    *sum += if v.is_finite() { f64::from(weight) * f64::from(value(*v)) } else { 0.0 };
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

    /// Convolves the cells, margin included.
    pub(crate) fn convolve(&mut self, convolver: &Convolver<f32>) {
        let source = std::mem::take(&mut self.values);
        self.values = vec![0.0; source.len()];
        convolver.apply(&source, &mut self.values, |to, v| *to = v);
    }

    /// Cell by cell, margin included.
    pub(crate) fn into_values(self) -> Vec<f32> {
        self.values
    }

    /// Divides each cell, margin included.
    pub(crate) fn divide(&mut self, by: &[f32]) {
        self.values.iter_mut().zip(by).for_each(|(value, by)| *value /= by);
    }

    /// Gives these cells, linear between their centers, to one line of what is finer.
    fn over_line(&self, y: f64, columns: &[(usize, f32)], line: &mut [f32], write: impl Fn(&mut f32, f32)) {
        let (j, v) = Self::place(y);
        let (upper, lower) = (&self.values[j * self.width..][..self.width], &self.values[(j + 1) * self.width..]);
        for (to, (i, u)) in line.iter_mut().zip(columns) {
            let a = upper[*i] + (lower[*i] - upper[*i]) * v;
            let b = upper[i + 1] + (lower[i + 1] - upper[i + 1]) * v;
            write(to, a + (b - a) * u);
        }
    }

    /// Where the columns of a plane of `width` pixels lie on the cells.
    pub(crate) fn columns(&self, width: usize) -> Vec<(usize, f32)> {
        (0..width).map(|i| Self::place((i as f64 + 0.5) / self.cell_px as f64)).collect()
    }

    /// Gives what the cells have at each pixel of the row `row` to `write`, with the pixel.
    pub(crate) fn over_row(
        &self,
        row: usize,
        columns: &[(usize, f32)],
        line: &mut [f32],
        write: impl Fn(&mut f32, f32),
    ) {
        self.over_line((row as f64 + 0.5) / self.cell_px as f64, columns, line, write);
    }

    /// Gives what the cells have at each pixel of a plane of `width` columns to `write`, with the pixel.
    pub(crate) fn over_pixels(&self, plane: &mut [f32], width: usize, write: impl Fn(&mut f32, f32) + Sync) {
        let columns = self.columns(width);
        plane.par_chunks_mut(width).enumerate().for_each(|(row, line)| self.over_row(row, &columns, line, &write));
    }

    /// Adds these cells to those of a finer level, `step` of which make one, its margin included.
    pub(crate) fn add_to_cells(&self, finer: &mut Self, step: usize) {
        let center = |k: usize| (k as f64 + 0.5 - MARGIN as f64) / step as f64;
        let columns: Vec<_> = (0..finer.width).map(|i| Self::place(center(i))).collect();
        let width = finer.width;
        finer.values.par_chunks_mut(width).enumerate().for_each(|(row, line)| {
            self.over_line(center(row), &columns, line, |to, v| *to += v);
        });
    }
}
