use super::super::cell::{Cell, Coverage};
use super::times;

/// A rectangle at any angle.
#[derive(Clone, Copy, Debug)]
pub struct Rectangle {
    center_mm: [f64; 2],
    half_mm: [f64; 2],
    cos: f64,
    sin: f64,
}

impl Rectangle {
    /// Creates an upright rectangle centered on `center_mm`, `width_mm` x `height_mm`.
    #[must_use]
    pub fn new(center_mm: [f64; 2], width_mm: f64, height_mm: f64) -> Self {
        Self { center_mm, half_mm: [0.5 * width_mm, 0.5 * height_mm], cos: 1.0, sin: 0.0 }
    }

    /// Creates an upright rectangle from its lower left and upper right corners, mm.
    #[must_use]
    pub fn between(low_mm: [f64; 2], high_mm: [f64; 2]) -> Self {
        let center_mm = [0.5 * (low_mm[0] + high_mm[0]), 0.5 * (low_mm[1] + high_mm[1])];
        Self::new(center_mm, high_mm[0] - low_mm[0], high_mm[1] - low_mm[1])
    }

    /// Returns this rectangle turned about its center so that its width runs at `angle_rad` from +x, counterclockwise.
    #[must_use]
    pub fn turned(self, angle_rad: f64) -> Self {
        Self { cos: libm::cos(angle_rad), sin: libm::sin(angle_rad), ..self }
    }

    fn local(&self, x_mm: f64, y_mm: f64) -> [f64; 2] {
        let (dx, dy) = (x_mm - self.center_mm[0], y_mm - self.center_mm[1]);
        [dx * self.cos + dy * self.sin, dy * self.cos - dx * self.sin]
    }

    /// Returns whether the point lies in the rectangle.
    #[inline]
    #[must_use]
    pub fn contains(&self, x_mm: f64, y_mm: f64) -> bool {
        let [u, v] = self.local(x_mm, y_mm);
        u.abs() <= self.half_mm[0] && v.abs() <= self.half_mm[1]
    }

    /// Returns how much of `cell` the rectangle covers; exact, by the four separating axes of two rectangles.
    #[must_use]
    pub fn coverage(&self, cell: &Cell) -> Coverage {
        let [u, v] = self.local(cell.center_mm[0], cell.center_mm[1]).map(f64::abs);
        let [eu, ev] = cell.half_along(self.cos, self.sin);
        let [w, h] = self.half_mm;
        if u + eu <= w && v + ev <= h {
            return Coverage::Full;
        }
        let (c, s) = (self.cos.abs(), self.sin.abs());
        let reach = [w * c + h * s, w * s + h * c];
        let apart = u - eu > w
            || v - ev > h
            || (0..2).any(|k| (cell.center_mm[k] - self.center_mm[k]).abs() > cell.half_mm[k] + reach[k]);
        if apart { Coverage::None } else { Coverage::Partial }
    }

    pub(super) fn scaled(self, factor: f64) -> Self {
        Self { center_mm: times(self.center_mm, factor), half_mm: times(self.half_mm, factor), ..self }
    }
}
