//! The least that makes a surface: its sag.

use super::per_ray::passes_beside;
use super::search::nearest_crossing;
use super::{Interface, Intersection, ScalarShape, Travel, by_batch};
use crate::RayBatch;
use crate::isa::Isa;
use glam::DVec3;

/// A surface given by its sag z(x, y).
pub trait SagShape: Send + Sync + std::fmt::Debug {
    /// Sag at a point, mm from the vertex plane; `None` where the surface does not reach.
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64>;

    /// Slopes dz/dx and dz/dy. By default taken from the sag by differences; give them where you know them, and tracing is
    /// faster and exact.
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

    /// Sag and slopes at once: give it where both cost less together than apart.
    fn sag_and_slope(&self, x_mm: f64, y_mm: f64) -> Option<(f64, (f64, f64))> {
        Some((self.sag_mm(x_mm, y_mm)?, self.slope(x_mm, y_mm)?))
    }

    /// As [`ScalarShape::extent_mm`]: give it where the sag is costly, and most rays of a search pass beside the surface.
    fn extent_mm(&self, _radius_mm: f64) -> Option<[f64; 2]> {
        None
    }

    /// As [`super::Surface::vertex_curvature_per_mm`]; by default from differences of the sag.
    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        let h = 1e-3;
        let second = |dx: f64, dy: f64| {
            let at = |x: f64, y: f64| self.sag_mm(x, y).unwrap_or(0.0);
            (at(dx, dy) - 2.0 * at(0.0, 0.0) + at(-dx, -dy)) / (h * h)
        };
        (second(h, 0.0), second(0.0, h))
    }
}

/// Turns a [`SagShape`] into a [`ScalarShape`]: a ray hits it where it crosses the sag in its direction of travel. Under
/// [`PerRay`](super::PerRay) whole batches step toward it side by side.
#[derive(Clone, Debug)]
pub struct FromSag<S>(pub S);

impl<S: SagShape> ScalarShape for FromSag<S> {
    fn intersect(&self, position: DVec3, direction: DVec3) -> Option<Intersection> {
        if direction.z == 0.0 {
            return None;
        }
        let travel = if direction.z > 0.0 { Travel::Forward } else { Travel::Backward };
        // Distances count from the vertex plane, so that a far source costs no digits.
        let to_plane = -position.z / direction.z;
        let origin = position + to_plane * direction;
        let height = |t: f64| {
            let p = origin + t * direction;
            let (sag, (sx, sy)) = self.0.sag_and_slope(p.x, p.y)?;
            Some((p.z - sag, direction.z - direction.x * sx - direction.y * sy))
        };
        let t = nearest_crossing(height, origin, direction, travel, 0.0)?;
        let p = origin + t * direction;
        let (sx, sy) = self.0.slope(p.x, p.y)?;
        Some(Intersection { distance_mm: to_plane + t, normal: DVec3::new(-sx, -sy, 1.0) })
    }
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        self.0.sag_mm(x_mm, y_mm)
    }
    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        self.0.vertex_curvature_per_mm()
    }
    fn extent_mm(&self, radius_mm: f64) -> Option<[f64; 2]> {
        self.0.extent_mm(radius_mm)
    }
    fn by_batch(&self, rays: &mut RayBatch, interface: &Interface<'_>, isa: Isa) -> Option<usize> {
        let clip2 = interface.clip_radius2_mm2;
        let extent = if clip2.is_finite() { self.0.extent_mm(clip2.sqrt()) } else { None };
        let beside = extent.map(|extent| move |p: DVec3, d: DVec3| passes_beside(p, d, clip2, extent));
        Some(by_batch::interact(self, rays, interface, isa, beside))
    }
}
