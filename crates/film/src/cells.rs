//! Planes of cells that are several pixels wide, on which smooth quantities are computed.
//!
//! A value is shared out to the cells around it, and cells are interpolated at pixels, both linearly by distance. Each of the two blurs by
//! a variance of a sixth of a squared cell along either axis. A kernel can compensate for that beforehand ([`Kernel::sharpened`]).
//!
//! [`Kernel::sharpened`]: spectra_numerics::convolve::Kernel::sharpened

use rayon::prelude::*;
use spectra_numerics::convolve::Convolver;

/// Number of cells around the frame, so that its border can be interpolated.
pub(crate) const MARGIN: usize = 2;

/// Number of cells of `cell_px` along an axis of `pixels`, including [`MARGIN`] on both sides.
pub(crate) fn with_margin(pixels: usize, cell_px: usize) -> usize {
    pixels.div_ceil(cell_px) + 2 * MARGIN
}

/// Blur by sharing out and interpolation together: half of the variance along an axis, divided by the squared cell width.
pub(crate) const BOTH_WAYS: f64 = 1.0 / 6.0;

/// A plane of cells, including [`MARGIN`] around the frame.
pub(crate) struct Cells {
    cell_px: usize,
    width: usize,
    values: Vec<f32>,
}

impl Cells {
    /// Averages `value` of a frame's pixels over cells of `cell_px` pixels; sum and center of gravity are kept. Values that are not finite
    /// count as 0.
    pub(crate) fn of_pixels(
        plane: &[f32],
        frame: [usize; 2],
        cell_px: usize,
        value: impl Fn(f32) -> f32 + Sync,
    ) -> Self {
        Self::shared(plane, frame[0], 0, frame, [1, cell_px], value)
    }

    /// Averages these cells, which belong to a frame of `frame` pixels, over cells that are `step` times as wide.
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
            // Rows that share with this one are adjacent.
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

    /// Returns the column or row before the place `x`, and the weight of the next one. `x` is the center of a pixel or cell, in units of
    /// these cells from the frame's border.
    fn place(x: f64) -> (usize, f32) {
        let p = x - 0.5 + MARGIN as f64;
        let k = p.floor();
        (k as usize, (p - k) as f32)
    }

    /// Convolves the cells, including the margin.
    pub(crate) fn convolve(&mut self, convolver: &Convolver<f32>) {
        let source = std::mem::take(&mut self.values);
        self.values = vec![0.0; source.len()];
        convolver.apply(&source, &mut self.values, |to, v| *to = v);
    }

    /// Returns the values of all cells, including the margin.
    pub(crate) fn into_values(self) -> Vec<f32> {
        self.values
    }

    /// Divides the cells by `by`, including the margin.
    pub(crate) fn divide(&mut self, by: &[f32]) {
        self.values.iter_mut().zip(by).for_each(|(value, by)| *value /= by);
    }

    /// Passes the values of these cells, interpolated between their centers, to one line of a finer grid.
    fn over_line(&self, y: f64, columns: &[(usize, f32)], line: &mut [f32], write: impl Fn(&mut f32, f32)) {
        let (j, v) = Self::place(y);
        let (upper, lower) = (&self.values[j * self.width..][..self.width], &self.values[(j + 1) * self.width..]);
        for (to, (i, u)) in line.iter_mut().zip(columns) {
            let a = upper[*i] + (lower[*i] - upper[*i]) * v;
            let b = upper[i + 1] + (lower[i + 1] - upper[i + 1]) * v;
            write(to, a + (b - a) * u);
        }
    }

    /// Returns the cell positions of the columns of a plane of `width` pixels.
    pub(crate) fn columns(&self, width: usize) -> Vec<(usize, f32)> {
        (0..width).map(|i| Self::place((i as f64 + 0.5) / self.cell_px as f64)).collect()
    }

    /// Calls `write` with each pixel of the row `row` and the interpolated value of the cells there.
    pub(crate) fn over_row(
        &self,
        row: usize,
        columns: &[(usize, f32)],
        line: &mut [f32],
        write: impl Fn(&mut f32, f32),
    ) {
        self.over_line((row as f64 + 0.5) / self.cell_px as f64, columns, line, write);
    }

    /// Calls `write` with each pixel of a plane of `width` columns and the interpolated value of the cells there.
    pub(crate) fn over_pixels(&self, plane: &mut [f32], width: usize, write: impl Fn(&mut f32, f32) + Sync) {
        let columns = self.columns(width);
        plane.par_chunks_mut(width).enumerate().for_each(|(row, line)| self.over_row(row, &columns, line, &write));
    }

    /// Adds these cells to those of a finer level, including its margin. A cell is `step` finer cells wide.
    pub(crate) fn add_to_cells(&self, finer: &mut Self, step: usize) {
        let center = |k: usize| (k as f64 + 0.5 - MARGIN as f64) / step as f64;
        let columns: Vec<_> = (0..finer.width).map(|i| Self::place(center(i))).collect();
        let width = finer.width;
        finer.values.par_chunks_mut(width).enumerate().for_each(|(row, line)| {
            self.over_line(center(row), &columns, line, |to, v| *to += v);
        });
    }
}
