//! Intersection of rays with a surface that is given by its sag.

use super::per_ray::passes_beside;
use super::search::nearest_crossing;
use super::{Interface, Intersection, SagShape, ScalarShape, Travel, by_batch};
use crate::RayBatch;
use glam::DVec3;

/// Turns a [`SagShape`] into a [`ScalarShape`]: a ray hits the surface where it crosses the sag in its direction of travel. In
/// [`PerRay`](super::PerRay), the rays of a batch step toward the surface side by side.
#[derive(Clone, Debug)]
pub struct FromSag<S>(pub S);

impl<S: SagShape> ScalarShape for FromSag<S> {
    fn intersect(&self, position: DVec3, direction: DVec3) -> Option<Intersection> {
        if direction.z == 0.0 {
            return None;
        }
        let travel = if direction.z > 0.0 { Travel::Forward } else { Travel::Backward };
        // Distances count from the vertex plane, so that a far source costs no precision.
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
    fn scaled(&self, factor: f64) -> Option<Self> {
        self.0.scaled(factor).map(Self)
    }
    fn by_batch(&self, rays: &mut RayBatch, interface: &Interface<'_>) -> Option<usize> {
        let clip2 = interface.clip_radius2_mm2;
        let extent = if clip2.is_finite() { self.0.extent_mm(clip2.sqrt()) } else { None };
        let beside = extent.map(|extent| move |p: DVec3, d: DVec3| passes_beside(p, d, clip2, extent));
        Some(by_batch::interact(&self.0, self, rays, interface, beside))
    }
}
