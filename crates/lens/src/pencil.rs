//! The axial pencil of a lens that is not round: how much light of an axial object at infinity comes through, and how wide its cone is.
//!
//! Illuminance is the radiance times the cone's area in direction cosines, pi sin^2 theta' of a round one. So the cone that is not round
//! counts as the round one of the same area: two lenses that are each other's mirror images have the same f-number, and a gray card is as
//! bright through a decentered lens at f/4 as through any other.

use crate::{ApertureError, Indices, Lens, MarginalRay, Tracer};
use glam::{DVec2, DVec3};
use spectra_core::{Isa, math};

/// Ways out from the middle of the pencil on which its edge is looked for.
const SPOKES: usize = 64;
/// Steps on each that say between which two the edge lies, and halvings between them.
const STEPS: usize = 48;
const HALVINGS: usize = 44;
/// Steps of the secant to the stop of an f-number: it is nearly proportional.
const SECANTS: usize = 40;
/// How near the sine comes to the one asked for, in parts of it.
const NEAR: f64 = 1e-11;

/// A ray along the axis that comes through.
struct Passed {
    start: DVec2,
    /// Direction cosines behind the lens, in the frame of the image plane.
    cosines: DVec2,
    stop_height_mm: Option<f64>,
}

struct Pencil<'a> {
    lens: &'a Lens,
    tracer: Tracer,
    middle: DVec2,
    reach_mm: f64,
}

impl Pencil<'_> {
    fn ray(&self, start: DVec2) -> Option<Passed> {
        let path = self.tracer.path(start.extend(0.0), DVec3::Z, self.lens.reference_nm);
        if path.end.is_some() {
            return None;
        }
        let stop_height_mm = self.lens.stop().and_then(|stop| {
            let local = self.lens.elements[stop].pose.local_point(*path.points.get(stop + 1)?);
            Some(local.truncate().length())
        });
        let cosines = self.lens.image_pose.local_direction(path.direction).truncate();
        Some(Passed { start, cosines, stop_height_mm })
    }

    /// The last ray that passes on a way out; `None` where there is none, or where nothing ends it.
    fn edge(&self, way: DVec2) -> Option<Passed> {
        let at = |height: f64| self.ray(self.middle + height * way);
        let step = self.reach_mm / STEPS as f64;
        let passes: Vec<bool> = (0..=STEPS).map(|k| at(k as f64 * step).is_some()).collect();
        // From the middle out; where something stands in the middle, as in many mirror telescopes, from outside in.
        let inner = match passes[0] {
            true => passes.iter().position(|passes| !passes)? - 1,
            false => passes.iter().rposition(|passes| *passes).filter(|last| *last < STEPS)?,
        };
        let (mut low, mut high) = (inner as f64 * step, (inner + 1) as f64 * step);
        let mut best = at(low)?;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match at(middle) {
                Some(ray) => (low, best) = (middle, ray),
                None => high = middle,
            }
        }
        Some(best)
    }

    /// The round pencil of the same areas.
    fn marginal(&self) -> Option<MarginalRay> {
        let ways = (0..SPOKES).map(|k| math::sin_cos_turns(k as f64 / SPOKES as f64));
        let edge: Vec<Passed> = ways.map(|(sin, cos)| self.edge(DVec2::new(cos, sin))).collect::<Option<_>>()?;
        let stop_height_mm = edge.iter().filter_map(|ray| ray.stop_height_mm).reduce(f64::max);
        let radius = |of: fn(&Passed) -> DVec2| {
            let corners: Vec<DVec2> = edge.iter().map(of).collect();
            round_radius(&corners)
        };
        Some(MarginalRay { height_mm: radius(|ray| ray.start), sine: radius(|ray| ray.cosines), stop_height_mm })
    }
}

/// The radius of the circle that has the area of a closed curve through these points; a circle's own points give its radius.
fn round_radius(corners: &[DVec2]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let twice: f64 = corners.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum();
    let (sin, _) = math::sin_cos_turns(1.0 / corners.len() as f64);
    (twice.abs() / (corners.len() as f64 * sin)).sqrt()
}

impl Lens {
    /// Whether it is round but for the shapes of its apertures: what an f-number means does not depend on them.
    pub(crate) fn is_round_but_for_apertures(&self) -> bool {
        let mut plain = self.clone();
        plain.elements.iter_mut().for_each(|element| element.apertures.clear());
        plain.has_axis_of_revolution()
    }

    /// The axial pencil as a round one, through the stop's circle and all rims.
    pub(crate) fn axial_pencil(&self) -> Result<Option<MarginalRay>, ApertureError> {
        let mut lens = self.clone();
        if let Some(stop) = lens.stop() {
            lens.elements[stop].apertures.clear();
        }
        let largest_mm = lens.largest_semi_diameter_mm().ok_or(ApertureError::Unlimited)?;
        let tracer = Tracer::new(&lens, Indices::At(lens.reference_nm), Isa::Baseline)?;
        let chief = lens.chief_rays(f64::INFINITY, &[0.0])?.pop().flatten();
        let middle = chief.map_or(DVec2::ZERO, |ray| ray.start_mm.truncate());
        Ok(Pencil { lens: &lens, tracer, middle, reach_mm: 2.0 * largest_mm + middle.length() }.marginal())
    }

    /// The radius of the stop at which the axial pencil has this sine, whatever the rims; `None` where it never has.
    pub(crate) fn stop_of_sine(&self, sine: f64) -> Result<Option<f64>, ApertureError> {
        let Some(stop) = self.stop() else { return Err(ApertureError::NoStop) };
        let mut open = self.clone();
        for element in &mut open.elements {
            element.semi_diameter_mm = None;
            element.apertures.clear();
        }
        let sine_of = |radius_mm: f64| -> Result<Option<f64>, ApertureError> {
            let mut set = open.clone();
            set.elements[stop].semi_diameter_mm = Some(radius_mm);
            Ok(set.axial_pencil()?.map(|ray| ray.sine))
        };
        // By a narrow pencil first.
        let mut before = 1e-3 * self.first_order(self.reference_nm).efl_mm.abs() * sine;
        let Some(mut sine_before) = sine_of(before)? else { return Ok(None) };
        let mut radius = before * sine / sine_before;
        for _ in 0..SECANTS {
            let Some(found) = sine_of(radius)? else {
                // Too steep for the glass: nearer to what passes.
                radius = 0.5 * (radius + before);
                continue;
            };
            if (found / sine - 1.0).abs() < NEAR {
                return Ok(Some(radius));
            }
            let slope = (found - sine_before) / (radius - before);
            (before, sine_before) = (radius, found);
            radius += (sine - found) / slope;
            if !(radius > 0.0 && radius.is_finite()) {
                return Ok(None);
            }
        }
        Ok(Some(radius).filter(|_| (sine_before / sine - 1.0).abs() < 1e-9))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_and_an_ellipse_have_their_radii() {
        let points = |a: f64, b: f64| -> Vec<DVec2> {
            (0..SPOKES)
                .map(|k| math::sin_cos_turns(k as f64 / SPOKES as f64))
                .map(|(sin, cos)| DVec2::new(3.0 + a * cos, b * sin - 1.0))
                .collect()
        };
        assert!((round_radius(&points(2.0, 2.0)) - 2.0).abs() < 1e-14);
        assert!((round_radius(&points(8.0, 2.0)) - 4.0).abs() < 1e-14);
    }
}
