//! Optical path that surfaces add by themselves, such as gratings and ideal lenses.
//!
//! What an ideal lens adds depends on where the light comes from that it is to image ([`BentRay::object_mm`]). That follows for each
//! ray, at its own wavelength, from the distance that the lens is focused at: vertex by vertex by n'/s' = n/s + power, with the axis taken
//! as if it were straight. Light that enters from the image side comes from where that point is imaged.

use super::route::{Leg, Route};
use super::{Tracer, Work};
use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::loss::ALIVE;
use spectra_core::surface::{Action, BentRay, Travel};

impl Tracer {
    /// Adds to the optical paths of living rays what the surface of a leg, which they were just bent by, adds to them.
    pub(super) fn add_phase(&self, rays: &mut RayBatch, work: &Work, route: &Route, step: usize) {
        let leg = &route.legs[step];
        let surface = &self.elements[leg.at].surface;
        let Some(noted) = work.before.as_ref().filter(|_| surface.has_phase()) else { return };
        let len = rays.len();
        let before = noted.directions(len);
        let phases: Vec<f64> = (0..len)
            .map(|i| {
                if rays.states()[i] != ALIVE {
                    return 0.0;
                }
                let n = |medium: usize| work.media[medium].n.slice(len)[i];
                surface.phase_mm(&BentRay {
                    point: rays.positions().map(|c| c[i]).into(),
                    before: DVec3::from(before.map(|c| c[i])),
                    after: rays.directions().map(|c| c[i]).into(),
                    wavelength_nm: rays.wavelengths_nm()[i],
                    n_before: n(leg.before),
                    n_after: n(if leg.action == Action::Reflect { leg.before } else { leg.after }),
                    object_mm: self.object_mm(route, step, &n),
                })
            })
            .collect();
        rays.weight_columns().optical_path_mm.iter_mut().zip(phases).for_each(|(path, phase)| *path += phase);
    }

    /// Distance (mm), measured against the light, from the vertex of a leg to the point where the light of a route comes from, in
    /// media of these indices.
    fn object_mm(&self, route: &Route, step: usize, n: &dyn Fn(usize) -> f64) -> f64 {
        let start_mm = match route.enters {
            Travel::Forward => self.focused_mm,
            Travel::Backward => {
                let image_mm = self
                    .forward
                    .legs
                    .iter()
                    .fold(self.focused_mm, |object, leg| self.behind_mm(object + leg.length_mm, leg, n));
                let last_mm = self.elements.last().map_or(0.0, |e| e.along_axis_mm);
                -image_mm - (self.image.along_axis_mm - last_mm) * self.image.sense
            }
        };
        let before =
            route.legs[..step].iter().fold(start_mm, |object, leg| self.behind_mm(object + leg.length_mm, leg, n));
        before + route.legs[step].length_mm
    }

    /// Where light seems to come from behind the element of a leg, if it comes from `object_mm` before it: both against the light from
    /// the vertex.
    fn behind_mm(&self, object_mm: f64, leg: &Leg, n: &dyn Fn(usize) -> f64) -> f64 {
        let element = &self.elements[leg.at];
        if element.solid.is_some() {
            // The axis counts what is inside a prism as reduced.
            return object_mm;
        }
        let before = n(leg.before);
        let (after, [first, second]) = match leg.action {
            Action::Pass => return object_mm,
            Action::Reflect => (before, [before, -before]),
            Action::Refract => (n(leg.after), [before, n(leg.after)]),
        };
        // Powers are those for light along the surface's own z.
        let (first, second) = if leg.travel == Travel::Forward { (first, second) } else { (second, first) };
        let (_, power) = element.surface.paraxial_power_per_mm(first, second);
        after / (before / object_mm - power)
    }
}
