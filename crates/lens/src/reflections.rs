//! Light that surfaces reflect although they should pass it: which surfaces do, by which paths it goes, and where it enters.

use crate::aim::Sphere;
use crate::aperture::{Aperture, Shape};
use crate::coating::{Coating, MeasuredCoating};
use crate::{Element, Lens, LensMedium, Path, Tracer, Travel};
use glam::DVec3;
use spectra_core::surface::{Kernel, Plane};
use spectra_glass::Medium;
use std::sync::Arc;

impl Tracer {
    /// The elements that reflect part of the light that they should pass: refracting surfaces, but for those whose coating is
    /// ideal and whose cement holds, and for gratings and surfaces that scatter.
    #[must_use]
    pub fn reflecting(&self) -> Vec<usize> {
        (0..self.surfaces()).filter(|at| self.passage(*at).reflects()).collect()
    }
}

impl Path {
    /// All ways of forward light through a lens of this many elements with exactly `order` reflections, an even number, at these
    /// `surfaces` (in rising order): for 2 every pair of them.
    #[must_use]
    pub fn ghosts(elements: usize, surfaces: &[usize], order: usize) -> Vec<Self> {
        let mut all = Vec::new();
        let mut so_far = Vec::with_capacity(order);
        extend(elements, surfaces, order, &mut so_far, &mut all);
        all
    }

    /// The same without its last step, if that is at this element.
    #[must_use]
    pub fn before(mut self, element: usize) -> Self {
        if self.steps().last().is_some_and(|step| step.element == element) {
            self.truncate_last();
        }
        self
    }
}

fn extend(elements: usize, surfaces: &[usize], order: usize, so_far: &mut Vec<usize>, all: &mut Vec<Path>) {
    if so_far.len() == order {
        all.extend(Path::reflected(elements, Travel::Forward, so_far));
        return;
    }
    let last = so_far.last().copied();
    // Light runs forward before each reflection of an even number.
    let forward = so_far.len().is_multiple_of(2);
    for &next in surfaces {
        if last.is_none_or(|last| if forward { next > last } else { next < last }) {
            so_far.push(next);
            extend(elements, surfaces, order, so_far, all);
            so_far.pop();
        }
    }
}

impl Lens {
    /// The same lens with the imager as its last element, in the image plane: it reflects this part of the light by wavelength, nm,
    /// as a mirror does, within a polygon (corners in mm, frame of the image plane), and passes the rest.
    #[must_use]
    pub fn with_reflecting_imager(mut self, reflectance: impl Fn(f64) -> f64, corners_mm: Vec<[f64; 2]>) -> Self {
        let before = self.elements.last().map_or(0, |e| e.medium_after);
        // What is behind it does not matter, but for being another medium.
        self.media.push(LensMedium { medium: Medium::Constant(1.5), stated_nd: None, label: "imager".to_owned() });
        let coating = Coating::Measured(Arc::new(MeasuredCoating::new(|nm| 1.0 - reflectance(nm))));
        let shape = Shape::Polygon(corners_mm);
        self.elements.push(Element {
            coating: Some(coating),
            apertures: vec![Aperture { shape, center_mm: [0.0; 2], obscures: false }],
            pose: self.image_pose,
            ..Element::new("imager", Arc::new(Kernel(Plane::refracting())), before, self.media.len() - 1)
        });
        self
    }
}

/// What light that enters a lens has to cross: a sphere around the clear part of its first surface, mm, frame of the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrontOpening {
    center: DVec3,
    radius_mm: f64,
}

/// The disk across the line of sight that a [`FrontOpening`] covers as seen from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrontDisk {
    /// Its middle, mm.
    pub center: DVec3,
    /// Its radius away from the axis of the lens, mm.
    pub radial: DVec3,
    /// Its radius at right angles to that, mm.
    pub across: DVec3,
    /// Unit vector from the point to the middle.
    pub sight: DVec3,
}

impl FrontOpening {
    /// Of a lens; `None` where no surface states a size.
    #[must_use]
    pub fn of(lens: &Lens) -> Option<Self> {
        let Sphere { center, radius_mm } = Sphere::around(lens, Travel::Forward)?;
        Some(Self { center, radius_mm })
    }

    /// Its middle, mm.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// Its radius, mm.
    #[must_use]
    pub fn radius_mm(&self) -> f64 {
        self.radius_mm
    }

    /// As seen from a point, mm in the frame of the lens; `None` from inside.
    #[must_use]
    pub fn seen_from(&self, point: DVec3) -> Option<FrontDisk> {
        let (is_outside, disk) = self.disk_from(point);
        is_outside.then_some(disk)
    }

    /// The same: whether the point lies outside, and the disk, which is none from inside. Without a branch, so that loops over rays can be vectorized.
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
        // Tangents from the point to the sphere meet the plane through its middle here.
        let radius_mm = self.radius_mm * (distance2 / (distance2 - radius2)).sqrt();
        let (radial, across) = (across.cross(sight) * radius_mm, across * radius_mm);
        (distance2 > 1.0001 * radius2, FrontDisk { center: self.center, radial, across, sight })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_and_every_four_are_there_once() {
        // Pairs: n (n - 1) / 2. Of four, a > b < c > d: counted by hand for three surfaces.
        assert_eq!(Path::ghosts(11, &[0, 1, 2, 3, 4, 6, 7, 8, 9, 10], 2).len(), 45);
        let four = Path::ghosts(3, &[0, 1, 2], 4);
        let mut reflections: Vec<Vec<usize>> = four.iter().map(|p| p.reflections().collect()).collect();
        let mut want = Vec::new();
        for a in 0..3 {
            for b in 0..a {
                for c in b + 1..3 {
                    want.extend((0..c).map(|d| vec![a, b, c, d]));
                }
            }
        }
        reflections.sort();
        want.sort();
        assert_eq!(reflections, want);
    }

    /// Every line that meets the sphere crosses the disk, and one tangent to it crosses its edge.
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
