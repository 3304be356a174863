//! Single rays, for drawings and searches.

use super::{Route, Tracer};
use glam::DVec3;
use spectra_core::isa::Isa;
use spectra_core::{Loss, RayBatch};

/// The path of a single ray, surface by surface.
#[derive(Clone, Debug, PartialEq)]
pub struct RayPath {
    /// Points of the path (mm, frame of the lens): the start of the ray, then its point on each surface that it met.
    pub points: Vec<DVec3>,
    /// Index of the element at each point except the start.
    pub elements: Vec<usize>,
    /// Direction behind the last surface that the ray passed.
    pub direction: DVec3,
    /// Cause and surface (from 1) at which the ray ended; `None` if it left the lens.
    pub end: Option<(Loss, u32)>,
}

impl Tracer {
    /// Follows a single ray forward, surface by surface, for drawings and searches.
    ///
    /// `position` (mm) and the unit `direction` are in the frame of the lens; so are the points.
    #[must_use]
    pub fn path(&self, position: DVec3, direction: DVec3, wavelength_nm: f64) -> RayPath {
        self.path_along(&self.forward, position, direction, wavelength_nm)
    }

    /// Follows a single ray along a route that enters at the front, like [`Tracer::path`].
    #[must_use]
    pub fn path_along(&self, route: &Route, position: DVec3, direction: DVec3, wavelength_nm: f64) -> RayPath {
        let mut rays = RayBatch::new(1).on(Isa::Baseline);
        rays.restart(1);
        let c = rays.columns_mut();
        (c.x[0], c.y[0], c.z[0]) = position.into();
        (c.l[0], c.m[0], c.n[0]) = direction.into();
        c.wavelength_nm[0] = wavelength_nm;
        let mut work = self.work_in_place(1);
        let program = self.program(route, self.prepare(route, &rays, &mut work));
        let mut path = RayPath { points: vec![position], elements: Vec::new(), direction, end: None };
        for (step, leg) in route.legs.iter().enumerate() {
            let element = &self.elements[leg.at];
            for operation in program.of_leg(step) {
                self.apply(*operation, &mut rays, &mut work, (route, step));
            }
            rays.set_surface(leg.number());
            let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
            path.end = rays.loss(0);
            if path.end.is_none_or(|(cause, _)| cause == Loss::Vignetted) {
                path.elements.push(leg.at);
                path.points.push(element.pose.point(DVec3::new(x[0], y[0], z[0])));
            }
            if path.end.is_some() {
                break;
            }
            path.direction = element.pose.direction(DVec3::new(l[0], m[0], n[0]));
        }
        path
    }
}
