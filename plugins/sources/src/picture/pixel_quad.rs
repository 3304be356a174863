//! Interpolation between the four pixels around a point of a picture.

use spectra_core::math::floor_index;

/// Finds the last pixel whose center lies at or before a position along a side of `pixels` pixels. Also returns how far the position lies
/// beyond that center, as a fraction of the distance to the next one. Before the first center, returns the first pixel and 0.
#[inline(always)]
pub(super) fn along(place: f64, pixels: usize) -> (u32, f32) {
    let from_first = place - 0.5;
    let from_first = if from_first > 0.0 { from_first } else { 0.0 };
    let (pixel, below) = floor_index(from_first, (pixels - 1) as f64);
    (pixel, (from_first - below) as f32)
}

/// Draws a position under the tent of a cell along a side. The tent reaches to the centers of the neighbors; that of the outermost cells
/// is flat toward the rim. `part` is uniform in [0, 1).
#[inline(always)]
pub(super) fn tent(cell: usize, part: f64, cells: usize) -> f64 {
    let at_rim = if part < 0.5 { cell == 0 } else { cell + 1 == cells };
    let from_center = match (at_rim, part < 0.5) {
        (true, _) => part - 0.5,
        (false, true) => (2.0 * part).sqrt() - 1.0,
        (false, false) => 1.0 - (2.0 * (1.0 - part)).sqrt(),
    };
    cell as f64 + 0.5 + from_center
}

/// The four pixels around a point, and how far the point lies from the upper left one toward the others.
pub(crate) struct PixelQuad {
    cells: [usize; 4],
    part: [f32; 2],
}

impl PixelQuad {
    /// Returns the four pixels around a point of a picture of this size. Beyond the outermost centers these are the pixels at the rim.
    #[inline(always)]
    pub(super) fn of([column, row]: [f64; 2], size: [usize; 2]) -> Self {
        let [(c0, part_x), (r0, part_y)] = [along(column, size[0]), along(row, size[1])];
        Self::beside([c0, r0], [part_x, part_y], size)
    }

    /// Returns the spot at the given fractions of the distance from the pixel of this column and row to the next ones.
    #[inline(always)]
    pub(super) fn beside([c0, r0]: [u32; 2], part: [f32; 2], [width, height]: [usize; 2]) -> Self {
        let (c0, r0) = (c0 as usize, r0 as usize);
        let (c1, r1) = ((c0 + 1).min(width - 1), (r0 + 1).min(height - 1));
        let (upper, lower) = (r0 * width, r1 * width);
        Self { cells: [upper + c0, upper + c1, lower + c0, lower + c1], part }
    }

    /// Indices of the four pixels: two above, and two below.
    #[inline(always)]
    pub(super) fn cells(&self) -> [usize; 4] {
        self.cells
    }

    /// Interpolates linearly between the values of the four pixels.
    #[inline(always)]
    pub(crate) fn mix<const N: usize>(&self, value: impl Fn(usize) -> [f32; N]) -> [f32; N] {
        let [a, b, d, e] = self.cells;
        self.between([value(a), value(b), value(d), value(e)])
    }

    /// Interpolates linearly between these values at the four pixels.
    #[inline(always)]
    pub(crate) fn between<const N: usize>(&self, [a, b, d, e]: [[f32; N]; 4]) -> [f32; N] {
        let mut mixed = [0.0; N];
        for k in 0..N {
            let upper = a[k] + (b[k] - a[k]) * self.part[0];
            let lower = d[k] + (e[k] - d[k]) * self.part[0];
            mixed[k] = upper + (lower - upper) * self.part[1];
        }
        mixed
    }
}
