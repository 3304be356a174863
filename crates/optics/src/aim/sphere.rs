//! Spheres around the surface that rays meet first.

use glam::DVec3;
use spectra_core::math::{concentric_disk, sin_cos_turns};
use spectra_lens::Lens;
use spectra_tracer::Travel;

/// Factor by which the radius is enlarged, so that the sphere contains a tilted rim, too.
const SLACK: f64 = 1.1;

/// A sphere in space, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sphere {
    pub center: DVec3,
    pub radius_mm: f64,
}

impl Sphere {
    /// Returns the sphere around the clear part of the first surface that light meets, in the frame of the incoming light.
    /// If that surface states no size, four times the largest stated size is used. Returns `None` if no surface states one.
    pub fn around(lens: &Lens, travel: Travel) -> Option<Self> {
        let (element, pose) = match travel {
            Travel::Forward => lens.elements.first().map(|e| (e, e.pose))?,
            Travel::Backward => lens.elements.last().map(|e| (e, lens.image_pose.inverse().then(&e.pose)))?,
        };
        let largest = lens.largest_semi_diameter_mm()?;
        let rim = element.semi_diameter_mm.unwrap_or(4.0 * largest);
        let sag = element.surface.sag_mm(rim, 0.0).unwrap_or(0.0);
        let radius_mm = SLACK * (rim * rim + 0.25 * sag * sag).sqrt();
        Some(Self { center: pose.point(DVec3::new(0.0, 0.0, 0.5 * sag)), radius_mm })
    }

    /// Draws a ray from `point` to the sphere, evenly over the solid angle of a disk that covers it: the point where the ray
    /// starts, its direction, and its weight in sr. From a point inside, rays go evenly in all directions.
    pub fn aim(&self, point: DVec3, u: f64, v: f64) -> (DVec3, DVec3, f64) {
        let to = self.center - point;
        let distance2 = to.length_squared();
        let radius2 = self.radius_mm * self.radius_mm;
        if distance2 <= 1.01 * radius2 {
            let height = 2.0 * u - 1.0;
            let (sin, cos) = sin_cos_turns(v);
            let beside = (1.0 - height * height).max(0.0).sqrt();
            return (point, DVec3::new(beside * cos, beside * sin, height), 4.0 * std::f64::consts::PI);
        }
        let axis = to / distance2.sqrt();
        let radius = self.radius_mm / (1.0 - radius2 / distance2).sqrt();
        let (a, b) = axis.any_orthonormal_pair();
        let (p, q) = concentric_disk(u, v);
        let target = self.center + (a * p + b * q) * radius;
        let way = target - point;
        let direction = way.normalize();
        let area = std::f64::consts::PI * radius * radius;
        (target, direction, area * direction.dot(axis) / way.length_squared())
    }
}
