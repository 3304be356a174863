//! Nodes: the points that represent zones, and the light that passes from each of them.

use super::probe::{Bounds, PassingPoints, Plane, Prober};
use super::region_shape::hull;
use super::sphere::Sphere;
use glam::DVec3;
use spectra_tracer::Travel;

/// The coordinates by which the search describes points: the angle at which the reference point sees them, the
/// depth and the azimuth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Geometry {
    pub travel: Travel,
    /// Position of the reference point on the axis, mm.
    pub eye_z_mm: f64,
    /// Sphere around the surface that is met first.
    pub bound: Sphere,
}

impl Geometry {
    /// Returns +1 if points lie at smaller z than the lens, otherwise -1.
    pub fn sense(&self) -> f64 {
        if self.travel == Travel::Forward { 1.0 } else { -1.0 }
    }

    pub fn eye(&self) -> DVec3 {
        DVec3::new(0.0, 0.0, self.eye_z_mm)
    }

    /// Returns the point at a measure of the angle (see [`measure`](super::measure::measure)), a depth (one over the distance for forward
    /// travel, mm ahead for backward travel) and an azimuth in turns. Returns `None` if there is none: no point behind
    /// the reference point has a depth on the film's side.
    pub fn point(&self, measure: f64, depth: f64, turns: f64) -> Option<DVec3> {
        let (radius, ahead) = if measure <= 1.0 { (measure, 1.0 - measure) } else { (2.0 - measure, 1.0 - measure) };
        let scale = if self.travel == Travel::Forward {
            1.0 / (depth.max(self.least_depth()) * (radius * radius + ahead * ahead).sqrt())
        } else {
            depth / ahead
        };
        let (sin, cos) = spectra_core::math::sin_cos_turns(turns);
        let beside = radius * scale;
        let point = DVec3::new(beside * cos, beside * sin, self.eye_z_mm - self.sense() * ahead * scale);
        (scale > 0.0 && point.is_finite()).then_some(point)
    }

    /// Depth that represents infinity: so far away that nothing moves by more than rounding.
    fn least_depth(&self) -> f64 {
        1e-8 / self.bound.radius_mm
    }

    /// Returns the plane through the reference point at right angles to the direction to `point`; `turns` is
    /// its azimuth, which a point on the axis does not determine.
    pub fn plane(&self, point: DVec3, turns: f64) -> Plane {
        let (sin, cos) = spectra_core::math::sin_cos_turns(turns);
        let radial = DVec3::new(cos, sin, 0.0);
        let across = DVec3::new(-sin, cos, 0.0);
        let way = (self.eye() - point).normalize();
        // The direction away from the axis, rotated into the plane.
        let along = (radial - way * radial.dot(way)).normalize();
        Plane { origin: self.eye(), along, across }
    }

    /// Returns a rectangle on that plane that contains everything that can meet the first surface.
    pub fn whole(&self, point: DVec3, plane: &Plane) -> Bounds {
        let to = self.bound.center - point;
        let distance = to.length();
        let axis = plane.along.cross(plane.across);
        let axis = axis * axis.dot(to).signum();
        let to_plane = (plane.origin - point).dot(axis);
        // In the plane of the point and the axis, the center of the sphere is off the plane's normal by one angle
        // and its edge by another. Directions nearly along the plane are limited.
        let off = (to.dot(plane.along) / distance).clamp(-1.0, 1.0);
        let off = spectra_core::math::asin(off);
        let half = spectra_core::math::asin((self.bound.radius_mm / distance).min(1.0));
        let tangent = |angle: f64| to_plane * spectra_core::math::tan(angle.clamp(-1.4, 1.4));
        let (low, high) = (tangent(off - half), tangent(off + half));
        // Across that plane, the edge is farthest away where the plane is.
        let farthest = (low * low).max(high * high) + to_plane * to_plane;
        let sin = (self.bound.radius_mm / distance).min(0.98);
        let across = farthest.sqrt() * sin / (1.0 - sin * sin).sqrt();
        Bounds { low: [low, -across], high: [high, across] }
    }

    /// Searches the light that passes from one point, and its edges at each of these wavelengths.
    pub fn node(
        &self,
        prober: &mut Prober<'_>,
        measure: f64,
        depth: f64,
        turns: f64,
        grid: usize,
        colors_nm: &[f64],
    ) -> Option<Node> {
        let point = self.point(measure, depth, turns)?;
        let plane = self.plane(point, turns);
        let start = self.whole(point, &plane);
        let PassingPoints { places, cell } = prober.search(point, &plane, start, grid)?;
        let bounds = Bounds::around(&places)?;
        let (sin, cos) = spectra_core::math::sin_cos_turns(turns);
        let local = |p: DVec3| DVec3::new(p.x * cos + p.y * sin, -p.x * sin + p.y * cos, p.z);
        let many = places.len() as f64;
        let middle = std::array::from_fn(|i| places.iter().map(|p| p[i]).sum::<f64>() / many);
        let edges = if colors_nm.is_empty() {
            Vec::new()
        } else {
            prober.edges(point, &plane, middle, &bounds.widened(cell.map(|c| 1.5 * c)), colors_nm)
        };
        let edges = edges.into_iter().map(|line| line.into_iter().map(|p| local(plane.at(p))).collect()).collect();
        Some(Node {
            edges,
            point: local(point),
            targets: hull(&places).into_iter().map(|p| local(plane.at(p))).collect(),
            center: local(plane.at(bounds.center())),
            cell,
        })
    }
}

/// The light that passes from one point, in the point's own frame: x away from the axis, y across, z along the axis.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub point: DVec3,
    /// Corners of the hull around all points that rays pass through.
    pub targets: Vec<DVec3>,
    /// Middle of the bounds of these points.
    pub center: DVec3,
    /// Largest distance beyond each point at which light may pass undetected, mm.
    pub cell: [f64; 2],
    /// Closed line around the light that passes, for each wavelength; empty if nothing was seen there.
    pub edges: Vec<Vec<DVec3>>,
}
