use super::super::cell::{Cell, Coverage};
use super::times;

/// A ring between two radii; a disk if the inner one is 0.
#[derive(Clone, Copy, Debug)]
pub struct Ring {
    center_mm: [f64; 2],
    inner_mm: f64,
    outer_mm: f64,
}

impl Ring {
    /// Creates a ring of width `width_mm` centered on the radius `radius_mm`.
    #[must_use]
    pub fn new(center_mm: [f64; 2], radius_mm: f64, width_mm: f64) -> Self {
        Self { center_mm, inner_mm: (radius_mm - 0.5 * width_mm).max(0.0), outer_mm: radius_mm + 0.5 * width_mm }
    }

    /// Creates a disk of radius `radius_mm`.
    #[must_use]
    pub fn disk(center_mm: [f64; 2], radius_mm: f64) -> Self {
        Self { center_mm, inner_mm: 0.0, outer_mm: radius_mm }
    }

    /// Returns whether the point lies in the ring.
    #[inline]
    #[must_use]
    pub fn contains(&self, x_mm: f64, y_mm: f64) -> bool {
        let (dx, dy) = (x_mm - self.center_mm[0], y_mm - self.center_mm[1]);
        let r2 = dx * dx + dy * dy;
        r2 <= self.outer_mm * self.outer_mm && r2 >= self.inner_mm * self.inner_mm
    }

    /// Returns whether the ring covers none, part or all of `cell`. The answer is exact: `Partial` means that the ring covers
    /// only part of it.
    #[must_use]
    pub fn coverage(&self, cell: &Cell) -> Coverage {
        let [near, far] = cell.distance_squared(self.center_mm);
        let (inner, outer) = (self.inner_mm * self.inner_mm, self.outer_mm * self.outer_mm);
        if near > outer || far < inner {
            Coverage::None
        } else if far <= outer && near >= inner {
            Coverage::Full
        } else {
            Coverage::Partial
        }
    }

    pub(super) fn scaled(self, factor: f64) -> Self {
        Self {
            center_mm: times(self.center_mm, factor),
            inner_mm: self.inner_mm * factor,
            outer_mm: self.outer_mm * factor,
        }
    }
}
