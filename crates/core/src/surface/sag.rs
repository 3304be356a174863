//! The smallest thing that makes a surface: its sag.

use super::{Intersection, ScalarShape};
use glam::DVec3;

/// A surface given by its sag z(x, y).
pub trait SagShape: Send + Sync + std::fmt::Debug {
    /// Sag at a point, mm from the vertex plane; `None` where the surface does not reach.
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64>;

    /// Slopes dz/dx and dz/dy. Derived from the sag by differences unless given: give them where
    /// they are known, the tracing gets faster and exact.
    fn slope(&self, x_mm: f64, y_mm: f64) -> Option<(f64, f64)> {
        // Rounding of the sag over the step, and the fourth power of the step, meet near 1e-11 here.
        let h = 1e-3;
        let along = |dx: f64, dy: f64| -> Option<f64> {
            let a = self.sag_mm(x_mm - dx, y_mm - dy)?;
            let b = self.sag_mm(x_mm + dx, y_mm + dy)?;
            let a2 = self.sag_mm(x_mm - 2.0 * dx, y_mm - 2.0 * dy)?;
            let b2 = self.sag_mm(x_mm + 2.0 * dx, y_mm + 2.0 * dy)?;
            Some((8.0 * (b - a) - (b2 - a2)) / (12.0 * h))
        };
        Some((along(h, 0.0)?, along(0.0, h)?))
    }
}

/// Makes a [`ScalarShape`] of a [`SagShape`], by Newton's method.
#[derive(Clone, Debug)]
pub struct FromSag<S>(pub S);

/// Newton's method on a smooth sag gains about one doubling of digits a step from the vertex plane:
/// five reach 1e-13 mm on lens surfaces; the rest is for steep ones.
const STEPS: usize = 50;
/// Halvings of a step that leads beyond the rim: 1/1000 of it.
const HALVINGS: usize = 10;
/// Where a step is smaller than this, mm, the ray has arrived.
const ARRIVED_MM: f64 = 1e-12;

impl<S: SagShape> ScalarShape for FromSag<S> {
    fn intersect(&self, position: DVec3, direction: DVec3) -> Option<Intersection> {
        if direction.z == 0.0 {
            return None;
        }
        let at = |t: f64| {
            let p = position + t * direction;
            self.0.sag_mm(p.x, p.y).map(|sag| (p, sag))
        };
        // From the vertex plane; where the surface does not reach out to there, from the point nearest to the axis.
        let across = direction.x * direction.x + direction.y * direction.y;
        let nearest = -(position.x * direction.x + position.y * direction.y) / across;
        let mut t = -position.z / direction.z;
        let (mut p, mut sag) = match at(t) {
            Some(found) => found,
            None => {
                t = nearest;
                at(t)?
            }
        };
        for _ in 0..STEPS {
            let (sx, sy) = self.0.slope(p.x, p.y)?;
            let normal = DVec3::new(-sx, -sy, 1.0);
            let mut step = (sag - p.z) / direction.dot(normal);
            if !step.is_finite() {
                return None;
            }
            // A step beyond the rim of the surface is halved until it is on it.
            let mut next = at(t + step);
            for _ in 0..HALVINGS {
                if next.is_some() {
                    break;
                }
                step *= 0.5;
                next = at(t + step);
            }
            (p, sag) = next?;
            t += step;
            if step.abs() < ARRIVED_MM * (1.0 + t.abs() * 1e-2) {
                let (sx, sy) = self.0.slope(p.x, p.y)?;
                return Some(Intersection { distance_mm: t, normal: DVec3::new(-sx, -sy, 1.0) });
            }
        }
        None
    }
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        self.0.sag_mm(x_mm, y_mm)
    }
    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        let h = 1e-3;
        let second = |dx: f64, dy: f64| {
            let at = |x: f64, y: f64| self.0.sag_mm(x, y).unwrap_or(0.0);
            (at(dx, dy) - 2.0 * at(0.0, 0.0) + at(-dx, -dy)) / (h * h)
        };
        (second(h, 0.0), second(0.0, h))
    }
}
