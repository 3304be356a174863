//! A cell of the acceleration grid, and how much of it a shape covers.

/// The part of a cell that a shape covers.
///
/// `None` and `Full` are guarantees: no point, or every point, of the cell lies in the shape. `Partial` guarantees nothing; a
/// shape returns it if it cannot decide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coverage {
    /// No point of the cell lies in the shape.
    None,
    /// Some points of the cell may lie in the shape, and some may not.
    Partial,
    /// Every point of the cell lies in the shape.
    Full,
}

/// An axis-parallel rectangle on the chart.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// Center of the cell, mm.
    pub center_mm: [f64; 2],
    /// Half width and half height of the cell, mm.
    pub half_mm: [f64; 2],
}

impl Cell {
    /// Returns how far the cell extends from its center along the direction (`cos`, `sin`) and along the normal of this
    /// direction, mm.
    #[must_use]
    pub fn half_along(&self, cos: f64, sin: f64) -> [f64; 2] {
        let [hx, hy] = self.half_mm;
        [hx * cos.abs() + hy * sin.abs(), hx * sin.abs() + hy * cos.abs()]
    }

    /// Half the diagonal of the cell, mm.
    #[must_use]
    pub fn half_diagonal_mm(&self) -> f64 {
        let [hx, hy] = self.half_mm;
        (hx * hx + hy * hy).sqrt()
    }

    /// Returns the smallest and the largest squared distance, mm^2, of points of the cell from `point_mm`.
    #[must_use]
    pub fn distance_squared(&self, point_mm: [f64; 2]) -> [f64; 2] {
        let mut least = 0.0;
        let mut largest = 0.0;
        for k in 0..2 {
            let offset = (point_mm[k] - self.center_mm[k]).abs();
            let near = (offset - self.half_mm[k]).max(0.0);
            let far = offset + self.half_mm[k];
            least += near * near;
            largest += far * far;
        }
        [least, largest]
    }

    /// Corners of the cell, mm, counterclockwise from the lower left.
    #[must_use]
    pub fn corners(&self) -> [[f64; 2]; 4] {
        let [cx, cy] = self.center_mm;
        let [hx, hy] = self.half_mm;
        [[cx - hx, cy - hy], [cx + hx, cy - hy], [cx + hx, cy + hy], [cx - hx, cy + hy]]
    }

    /// Returns quarter `index` of the cell: 0 lower left, 1 lower right, 2 upper left, 3 upper right.
    #[must_use]
    pub fn quarter(&self, index: usize) -> Self {
        let half_mm = [0.5 * self.half_mm[0], 0.5 * self.half_mm[1]];
        let sign = |bit: bool| if bit { 1.0 } else { -1.0 };
        Self {
            center_mm: [
                self.center_mm[0] + sign(index & 1 == 1) * half_mm[0],
                self.center_mm[1] + sign(index & 2 == 2) * half_mm[1],
            ],
            half_mm,
        }
    }

    /// Returns the cell extended by `margin_mm` on each side.
    #[must_use]
    pub fn padded(&self, margin_mm: f64) -> Self {
        Self { center_mm: self.center_mm, half_mm: [self.half_mm[0] + margin_mm, self.half_mm[1] + margin_mm] }
    }
}
