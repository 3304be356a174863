use super::super::cell::{Cell, Coverage};
use super::times;

/// A polygon given by its corners in either orientation, closed automatically; convex or not (even-odd rule).
#[derive(Clone, Debug)]
pub struct Polygon {
    corners_mm: Box<[[f64; 2]]>,
}

impl Polygon {
    /// Creates a polygon with the given corners, mm; one with fewer than three covers nothing.
    #[must_use]
    pub fn new(corners_mm: &[[f64; 2]]) -> Self {
        Self { corners_mm: corners_mm.into() }
    }

    fn edges(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
        let n = self.corners_mm.len();
        (0..n).map(move |i| (self.corners_mm[i], self.corners_mm[(i + 1) % n]))
    }

    /// Returns whether the point lies in the polygon, that is, whether a ray toward +x crosses its sides an odd number of times.
    #[inline]
    #[must_use]
    pub fn contains(&self, x_mm: f64, y_mm: f64) -> bool {
        let mut inside = false;
        for (a, b) in self.edges() {
            if (a[1] > y_mm) != (b[1] > y_mm) {
                let x = a[0] + (y_mm - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                inside ^= x_mm < x;
            }
        }
        inside
    }

    /// Returns how much of `cell` the polygon covers. Exact, since a cell that no side touches is all inside or all outside.
    #[must_use]
    pub fn coverage(&self, cell: &Cell) -> Coverage {
        if self.edges().any(|(a, b)| side_touches(a, b, cell)) {
            Coverage::Partial
        } else if self.contains(cell.center_mm[0], cell.center_mm[1]) {
            Coverage::Full
        } else {
            Coverage::None
        }
    }

    pub(super) fn scaled(self, factor: f64) -> Self {
        Self { corners_mm: self.corners_mm.iter().map(|&p| times(p, factor)).collect() }
    }
}

/// Returns whether the segment from `a` to `b` meets the cell, by separating axes.
fn side_touches(a: [f64; 2], b: [f64; 2], cell: &Cell) -> bool {
    let [cx, cy] = cell.center_mm;
    let [hx, hy] = cell.half_mm;
    let (ax, ay, bx, by) = (a[0] - cx, a[1] - cy, b[0] - cx, b[1] - cy);
    if ax.min(bx) > hx || ax.max(bx) < -hx || ay.min(by) > hy || ay.max(by) < -hy {
        return false;
    }
    let (dx, dy) = (bx - ax, by - ay);
    (ax * dy - ay * dx).abs() <= hx * dy.abs() + hy * dx.abs()
}
