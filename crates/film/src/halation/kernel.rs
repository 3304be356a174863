//! The spread of halation as a sum of kernels, each on a grid four times as coarse as the one before.
//!
//! The returned light falls with the fourth power of the distance but never ends, and is smooth outside the ring. So the ring is computed
//! on the pixels, and each further part on cells of four times the size, up to the frame's diagonal.

use super::base::HalationBase;
use super::returned_light::ReturnedLight;
use super::table::Table;
use crate::cells::{BOTH_WAYS, MARGIN};
use crate::raster::Raster;
use spectra_numerics::convolve::Kernel;

/// Ratio of the cell sizes of consecutive levels.
pub(super) const STEP: usize = 4;

/// Radius at which the first part ends, in radii of the ring.
const RINGS: f64 = 2.2;

/// Radius at which a part begins to fade into the next, relative to the radius at which it ends.
const FADE: f64 = 0.6;

/// Smallest and largest radius of each part, in cells.
const REACH: (f64, f64) = (24.0, 400.0);

/// One part of the spread, on cells of one size.
pub(super) struct Level {
    /// Side of the cells, in pixels: a power of [`STEP`].
    pub(super) cell_px: usize,
    /// Kernel of this part, in cells.
    pub(super) kernel: Kernel,
}

/// Smooth step: 1 up to `FADE * end`, 0 from `end` on.
fn fading(r: f64, end: f64) -> f64 {
    let x = ((end - r) / (end * (1.0 - FADE))).clamp(0.0, 1.0);
    x * x * x * (10.0 + x * (6.0 * x - 15.0))
}

impl Level {
    /// Builds all parts, finest first. Together with the light that stays they sum to 1, except for light that falls farther away than the
    /// frame is long.
    pub(super) fn all(base: &HalationBase, trips: &ReturnedLight, raster: &Raster) -> Vec<Self> {
        let ring = base.ring_radius_mm();
        let even = 1.0 / (1.0 + trips.returned());
        // If pixels are far finer than the ring, it is computed on cells that are still fine enough.
        let mut cell_px = 1;
        while RINGS * ring / (raster.pitch_mm * cell_px as f64) > REACH.1 {
            cell_px *= STEP;
        }
        let diagonal = ((raster.width * raster.width + raster.height * raster.height) as f64).sqrt() * raster.pitch_mm;
        let cell = raster.pitch_mm * cell_px as f64;
        let mut end = (RINGS * ring).max(REACH.0 * cell);
        let mut before: Option<f64> = None;
        let mut levels = Vec::new();
        loop {
            let weight = |r: f64| fading(r, end) - before.map_or(0.0, |b| fading(r, b));
            let cell = raster.pitch_mm * cell_px as f64;
            let radius = (end / cell).ceil() as usize;
            let density = |r: f64| weight(r) * trips.density_per_mm2(r);
            let kernel = if before.is_none() {
                let parts = (40.0 * cell / ring).ceil().clamp(4.0, 64.0) as usize;
                over_pixels(radius, cell, parts, &density)
            } else {
                let value = |i: f64, j: f64| density((i * i + j * j).sqrt() * cell);
                // Sharing light out to cells and interpolating between them each spread it by s^2 / 6, on average and along each axis. Half
                // of the sum, times the Laplacian, is subtracted beforehand.
                Kernel::new(radius, |i, j| {
                    let (i, j) = (i as f64, j as f64);
                    let around = value(i - 1.0, j) + value(i + 1.0, j) + value(i, j - 1.0) + value(i, j + 1.0);
                    value(i, j) - (around - 4.0 * value(i, j)) * BOTH_WAYS
                })
            };
            let mass = even * trips.returned_weighted(weight);
            let sum = kernel.sum();
            // A kernel without weight (everything is absorbed) stays zero.
            let kernel = kernel.scaled(if sum > 0.0 { mass / sum } else { 0.0 });
            let longest = raster.width.max(raster.height).div_ceil(cell_px) + 2 * MARGIN;
            levels.push(Self { cell_px, kernel: kernel.cropped(longest) });
            if FADE * end >= diagonal {
                return levels;
            }
            before = Some(end);
            end *= STEP as f64;
            cell_px *= STEP;
        }
    }
}

/// Builds the kernel on pixels: from an evenly bright pixel to the mean over another. The distance between points of two pixels has a tent
/// distribution two pixels wide, sampled by `parts` points per pixel.
fn over_pixels(radius: usize, pitch: f64, parts: usize, density: &(impl Fn(f64) -> f64 + Sync)) -> Kernel {
    // Sampled once over the radius, because the integrand is called for many points.
    let table = Table::new(pitch * (radius as f64 + 1.0) * 1.5, density);
    let offsets: Vec<(f64, f64)> = (0..2 * parts)
        .map(|k| {
            let x = (k as f64 + 0.5) / parts as f64 - 1.0;
            (x, (1.0 - x.abs()) / parts as f64)
        })
        .collect();
    Kernel::new(radius, |i, j| {
        let mut sum = 0.0;
        for (y, wy) in &offsets {
            let dy = (j as f64 + y) * pitch;
            let row = offsets.iter().map(|(x, wx)| {
                let dx = (i as f64 + x) * pitch;
                wx * table.at((dx * dx + dy * dy).sqrt())
            });
            sum += wy * row.sum::<f64>();
        }
        sum * pitch * pitch
    })
}
