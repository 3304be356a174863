//! The sphere around the front of a lens and the disk that it covers as seen from a point: where light for ghosts enters the lens.

use crate::aim::Sphere;
use glam::DVec3;
use spectra_lens::Lens;
use spectra_tracer::Travel;

/// A sphere around the clear part of the first surface, mm in the frame of the lens. All light that enters the lens crosses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrontOpening {
    center: DVec3,
    radius_mm: f64,
}

/// The disk that a [`FrontOpening`] covers as seen from a point, at right angles to the line of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrontDisk {
    /// Center of the disk, mm in the frame of the lens.
    pub center: DVec3,
    /// Radius vector of the disk in the direction away from the axis of the lens, mm.
    pub radial: DVec3,
    /// Radius vector of the disk at right angles to [`FrontDisk::radial`], mm.
    pub across: DVec3,
    /// Unit vector from the viewpoint to the center of the disk.
    pub sight: DVec3,
}

impl FrontOpening {
    /// Creates the sphere of a lens; `None` if no surface states a size.
    #[must_use]
    pub fn of(lens: &Lens) -> Option<Self> {
        let Sphere { center, radius_mm } = Sphere::around(lens, Travel::Forward)?;
        Some(Self { center, radius_mm })
    }

    /// Center of the sphere, mm in the frame of the lens.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// Radius of the sphere, mm.
    #[must_use]
    pub fn radius_mm(&self) -> f64 {
        self.radius_mm
    }

    /// Returns the disk that the sphere covers as seen from a point (mm, frame of the lens); `None` if the point lies inside the
    /// sphere.
    #[must_use]
    pub fn seen_from(&self, point: DVec3) -> Option<FrontDisk> {
        let (is_outside, disk) = self.disk_from(point);
        is_outside.then_some(disk)
    }

    /// Returns whether `point` (mm, frame of the lens) lies outside the sphere, and the disk that the sphere covers as seen from
    /// there. The disk is valid only if the point lies outside. Unlike [`FrontOpening::seen_from`], this function is branch-free,
    /// so loops over rays can be vectorized.
    #[must_use]
    #[inline(always)]
    pub fn disk_from(&self, point: DVec3) -> (bool, FrontDisk) {
        let way = self.center - point;
        let (distance2, radius2) = (way.length_squared(), self.radius_mm * self.radius_mm);
        let distance = distance2.sqrt();
        let sight = way / distance;
        let across = DVec3::Z.cross(sight);
        let size = across.length();
        let is_aside = size > 1e-12;
        let across = across / size;
        let across = DVec3::new(
            if is_aside { across.x } else { 1.0 },
            if is_aside { across.y } else { 0.0 },
            if is_aside { across.z } else { 0.0 },
        );
        // Tangents from the point to the sphere meet the plane through its center at this radius.
        let radius_mm = self.radius_mm * (distance2 / (distance2 - radius2)).sqrt();
        let (radial, across) = (across.cross(sight) * radius_mm, across * radius_mm);
        (distance2 > 1.0001 * radius2, FrontDisk { center: self.center, radial, across, sight })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every line that meets the sphere crosses the disk, and a tangent to the sphere crosses the edge of the disk.
    #[test]
    fn the_disk_covers_the_sphere() {
        let opening = FrontOpening { center: DVec3::new(0.0, 0.0, 2.0), radius_mm: 20.0 };
        for point in [DVec3::new(0.0, 0.0, -30.0), DVec3::new(300.0, -40.0, 10.0), DVec3::new(3.0, 25.0, -5.0)] {
            let disk = opening.seen_from(point).expect("outside");
            for k in 0..16 {
                let (sin, cos) = spectra_core::math::sin_cos_turns(f64::from(k) / 16.0);
                let way = (disk.center + disk.radial * cos + disk.across * sin - point).normalize();
                let from = opening.center - point;
                let miss = (from - way * from.dot(way)).length();
                assert!((miss - 20.0).abs() < 1e-9, "{miss}");
            }
            assert!(disk.radial.dot(disk.sight).abs() < 1e-9 && disk.across.dot(disk.sight).abs() < 1e-9);
        }
        assert!(opening.seen_from(DVec3::new(1.0, 1.0, -10.0)).is_none());
    }
}
