//! A place of a picture among its pixels.

/// Four pixels, and how far a place lies from the upper left one of them toward the others.
pub(crate) struct Spot {
    cells: [usize; 4],
    part: [f32; 2],
}

impl Spot {
    /// Around a place in a picture of these sides; at its rim those of the rim.
    #[inline(always)]
    pub(super) fn of([column, row]: [f64; 2], [width, height]: [usize; 2]) -> Self {
        let (c, r) = ((column - 0.5).max(0.0), (row - 0.5).max(0.0));
        let (c0, r0) = ((c as i32 as usize).min(width - 1), (r as i32 as usize).min(height - 1));
        let (c1, r1) = ((c0 + 1).min(width - 1), (r0 + 1).min(height - 1));
        let (upper, lower) = (r0 * width, r1 * width);
        Self {
            cells: [upper + c0, upper + c1, lower + c0, lower + c1],
            part: [(c - c0 as f64) as f32, (r - r0 as f64) as f32],
        }
    }

    /// The four pixels: two above, and two below.
    #[inline(always)]
    pub(super) fn cells(&self) -> [usize; 4] {
        self.cells
    }

    /// Linear between the values of the four pixels.
    #[inline(always)]
    pub(crate) fn mix<const N: usize>(&self, value: impl Fn(usize) -> [f32; N]) -> [f32; N] {
        let [a, b, d, e] = self.cells;
        self.between([value(a), value(b), value(d), value(e)])
    }

    /// Linear between these values of the four pixels.
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
