use super::super::cell::{Cell, Coverage};
use super::times;

/// A straight pen stroke with round ends.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    from_mm: [f64; 2],
    along_mm: [f64; 2],
    /// 1 / length^2, or 0 for a dot.
    inverse: f64,
    radius_mm: f64,
}

impl Stroke {
    /// Creates a stroke of a pen `width_mm` wide between two points (mm). If the points are equal, the stroke is a dot.
    #[must_use]
    pub fn new(from_mm: [f64; 2], to_mm: [f64; 2], width_mm: f64) -> Self {
        let along_mm = [to_mm[0] - from_mm[0], to_mm[1] - from_mm[1]];
        let length2 = along_mm[0] * along_mm[0] + along_mm[1] * along_mm[1];
        let inverse = if length2 > 0.0 { 1.0 / length2 } else { 0.0 };
        Self { from_mm, along_mm, inverse, radius_mm: 0.5 * width_mm }
    }

    fn distance_squared(&self, x_mm: f64, y_mm: f64) -> f64 {
        let (dx, dy) = (x_mm - self.from_mm[0], y_mm - self.from_mm[1]);
        let [ax, ay] = self.along_mm;
        let t = ((dx * ax + dy * ay) * self.inverse).clamp(0.0, 1.0);
        let (ex, ey) = (dx - t * ax, dy - t * ay);
        ex * ex + ey * ey
    }

    /// Returns whether the point lies on the stroke.
    #[inline]
    #[must_use]
    pub fn contains(&self, x_mm: f64, y_mm: f64) -> bool {
        self.distance_squared(x_mm, y_mm) <= self.radius_mm * self.radius_mm
    }

    /// Returns how much of `cell` the stroke covers, from its distance to the center of the cell.
    #[must_use]
    pub fn coverage(&self, cell: &Cell) -> Coverage {
        let distance_mm = self.distance_squared(cell.center_mm[0], cell.center_mm[1]).sqrt();
        by_distance(distance_mm, self.radius_mm, cell)
    }

    pub(super) fn scaled(self, factor: f64) -> Self {
        Self {
            from_mm: times(self.from_mm, factor),
            along_mm: times(self.along_mm, factor),
            inverse: self.inverse / (factor * factor),
            radius_mm: self.radius_mm * factor,
        }
    }
}

/// A pen stroke along part of a circle, with round ends.
#[derive(Clone, Copy, Debug)]
pub struct Arc {
    center_mm: [f64; 2],
    radius_mm: f64,
    pen_radius_mm: f64,
    /// Unit vector toward the start of the arc, which runs counterclockwise.
    start: [f64; 2],
    /// Unit vector toward the end of the arc.
    end: [f64; 2],
    over_half_turn: bool,
}

impl Arc {
    /// Creates an arc of a pen `width_mm` wide about `center_mm`. It starts at `start_rad` (from +x, counterclockwise) and
    /// sweeps over `sweep_rad`, in [-2 pi, 2 pi], counterclockwise if positive.
    #[must_use]
    pub fn new(center_mm: [f64; 2], radius_mm: f64, start_rad: f64, sweep_rad: f64, width_mm: f64) -> Self {
        let low_rad = start_rad.min(start_rad + sweep_rad);
        let high_rad = low_rad + sweep_rad.abs();
        Self {
            center_mm,
            radius_mm,
            pen_radius_mm: 0.5 * width_mm,
            start: [libm::cos(low_rad), libm::sin(low_rad)],
            end: [libm::cos(high_rad), libm::sin(high_rad)],
            over_half_turn: sweep_rad.abs() > std::f64::consts::PI,
        }
    }

    fn distance_mm(&self, x_mm: f64, y_mm: f64) -> f64 {
        let (dx, dy) = (x_mm - self.center_mm[0], y_mm - self.center_mm[1]);
        let after_start = self.start[0] * dy - self.start[1] * dx >= 0.0;
        let before_end = dx * self.end[1] - dy * self.end[0] >= 0.0;
        let swept = if self.over_half_turn { after_start || before_end } else { after_start && before_end };
        if swept {
            return ((dx * dx + dy * dy).sqrt() - self.radius_mm).abs();
        }
        let from = |[ux, uy]: [f64; 2]| {
            let (ex, ey) = (dx - self.radius_mm * ux, dy - self.radius_mm * uy);
            ex * ex + ey * ey
        };
        from(self.start).min(from(self.end)).sqrt()
    }

    /// Returns whether the point lies on the stroke.
    #[inline]
    #[must_use]
    pub fn contains(&self, x_mm: f64, y_mm: f64) -> bool {
        self.distance_mm(x_mm, y_mm) <= self.pen_radius_mm
    }

    /// Returns how much of `cell` the stroke covers, from its distance to the center of the cell.
    #[must_use]
    pub fn coverage(&self, cell: &Cell) -> Coverage {
        by_distance(self.distance_mm(cell.center_mm[0], cell.center_mm[1]), self.pen_radius_mm, cell)
    }

    pub(super) fn scaled(self, factor: f64) -> Self {
        Self {
            center_mm: times(self.center_mm, factor),
            radius_mm: self.radius_mm * factor,
            pen_radius_mm: self.pen_radius_mm * factor,
            ..self
        }
    }
}

/// Decides the coverage from the distance of the center of a cell. No point of the cell is farther from the center than half the
/// diagonal, so distances within the cell differ by no more than that.
fn by_distance(distance_mm: f64, limit_mm: f64, cell: &Cell) -> Coverage {
    let half_mm = cell.half_diagonal_mm();
    if distance_mm - half_mm > limit_mm {
        Coverage::None
    } else if distance_mm + half_mm <= limit_mm {
        Coverage::Full
    } else {
        Coverage::Partial
    }
}
