//! The marginal ray of an axial object at infinity, and the fraction of its light that the lens transmits.
//!
//! Irradiance is the radiance times the area of the cone in direction cosines, pi sin^2 theta' for a round cone. A lens that is not
//! round therefore counts as the round lens whose pencil has the same area. So two lenses that are mirror images of each other have the
//! same f-number, and a gray card is as bright through a decentered lens at f/4 as through any other.

use crate::aperture_error::ApertureError;
use crate::bundle::{Bundle, ObjectPoint, WindowLine};
use crate::{Clipping, Optics};
use glam::{DVec2, DVec3};
use spectra_core::loss::ALIVE;
use spectra_core::{RayBatch, math};
use spectra_glass::DispersionError;
use spectra_lens::Lens;
use spectra_tracer::{Indices, Travel};

/// The marginal ray of an axial object at infinity. If the lens is not round, the ray belongs to the round pencil that has the
/// same areas in front of and behind the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarginalRay {
    /// Height of the ray in front of the lens, mm: half the diameter of the real entrance pupil.
    pub height_mm: f64,
    /// Sine of the angle between the ray and the axis behind the lens.
    pub sine: f64,
    /// Height of the ray at the stop, mm; `None` if the lens has no stop.
    pub stop_height_mm: Option<f64>,
}

impl MarginalRay {
    /// Returns the f-number, N = 1 / (2 sin theta').
    #[must_use]
    pub fn f_number(&self) -> f64 {
        0.5 / self.sine
    }
}

/// Number of directions, from the middle of a pencil that is not round, in which its edge is searched.
const SPOKES: usize = 64;
/// Number of rays of the first scan in each direction.
const PROBES: usize = 64;
/// Accuracy of the edges, as a fraction of the line: to the last digit.
const ACCURACY: f64 = 1e-16;
/// Number of rings of equal area over the pupil that measure the transmittance. A lens that is not round has [`SPOKES`] rays on each.
const RINGS: usize = 256;

/// A ray parallel to the axis that passes the lens.
pub(crate) struct AxialRay {
    /// Position of the ray in front of the lens, mm from the axis.
    start: DVec2,
    /// Direction cosines behind the lens, in the frame of the image plane.
    cosines: DVec2,
    stop_height_mm: Option<f64>,
}

impl AxialRay {
    /// Follows the ray of an axial bundle through a point of its window; `None` if the ray does not pass.
    pub fn trace(optics: &Optics, bundle: &Bundle<'_>, place: [f64; 2]) -> Option<Self> {
        let path = bundle.path(place);
        if path.end.is_some() {
            return None;
        }
        let stop_height_mm = optics.stop().and_then(|stop| {
            let local = optics.elements[stop].pose.local_point(*path.points.get(stop + 1)?);
            Some(local.truncate().length())
        });
        let cosines = optics.image_pose.local_direction(path.direction).truncate();
        Some(Self { start: bundle.ray(place).0.truncate(), cosines, stop_height_mm })
    }

    /// Returns this ray as the marginal ray of a round lens.
    pub fn marginal(&self) -> MarginalRay {
        MarginalRay { height_mm: self.start.length(), sine: self.cosines.length(), stop_height_mm: self.stop_height_mm }
    }
}

/// Returns the bundle of rays parallel to the axis at the reference line.
pub(crate) fn axial_bundle(optics: &Optics, clipping: Clipping) -> Result<Bundle<'_>, ApertureError> {
    let bundle = Bundle::before(optics, ObjectPoint::Toward(DVec3::Z), Indices::At(optics.reference_nm))?;
    Ok(bundle.ok_or(ApertureError::Unlimited)?.clipped(clipping)?)
}

/// Returns the last passing ray on a line outward from the middle, for rays parallel to the axis. If something stands in the middle, as
/// in many mirror telescopes, this is the outermost passing ray. Returns `None` if nothing passes, or nothing limits the light.
fn edge(optics: &Optics, bundle: &Bundle<'_>, line: &WindowLine) -> Option<AxialRay> {
    let zones = bundle.zones(line, PROBES, ACCURACY);
    let zone = zones.first().filter(|zone| zone[0] == 0.0).or(zones.last())?;
    if zone[1] >= line.length_mm { None } else { AxialRay::trace(optics, bundle, line.at(zone[1])) }
}

impl Optics {
    /// Returns the marginal ray: the highest axial ray that passes the lens as it is set. If the lens is not round, it is the
    /// marginal ray of the round pencil of equal area.
    ///
    /// # Errors
    /// [`ApertureError::Unlimited`] if no rim limits the light, [`ApertureError::Medium`] if a medium has no usable index.
    pub fn marginal_ray(&self) -> Result<MarginalRay, ApertureError> {
        if self.largest_semi_diameter_mm().is_none() {
            return Err(ApertureError::Unlimited);
        }
        if is_round_but_for_apertures(self) {
            let bundle = axial_bundle(self, Clipping::RoundIris)?;
            let ray = edge(self, &bundle, &bundle.upward()).ok_or(ApertureError::Unlimited)?;
            return Ok(ray.marginal());
        }
        let open = axial_bundle(self, Clipping::None)?;
        let middle = self.stop().and_then(|stop| open.through(stop, DVec2::ZERO, [0.0; 2])).unwrap_or_default();
        let bundle = axial_bundle(self, Clipping::RoundStop)?;
        let edges = (0..SPOKES).map(|k| {
            let (sin, cos) = math::sin_cos_turns(k as f64 / SPOKES as f64);
            edge(self, &bundle, &WindowLine { from: middle, way: [cos, sin], length_mm: 2.0 * bundle.reach_mm() })
        });
        let edges: Vec<AxialRay> = edges.collect::<Option<_>>().ok_or(ApertureError::Unlimited)?;
        let stop_height_mm = edges.iter().filter_map(|ray| ray.stop_height_mm).reduce(f64::max);
        let radius = |of: fn(&AxialRay) -> DVec2| round_radius(&edges.iter().map(of).collect::<Vec<_>>());
        Ok(MarginalRay { height_mm: radius(|ray| ray.start), sine: radius(|ray| ray.cosines), stop_height_mm })
    }
}

/// Returns the radius of the circle with the area of a closed curve through these points. Points on a circle give exactly its radius.
fn round_radius(corners: &[DVec2]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let twice: f64 = corners.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum();
    let (sin, _) = math::sin_cos_turns(1.0 / corners.len() as f64);
    (twice.abs() / (corners.len() as f64 * sin)).sqrt()
}

/// Returns whether a lens is round apart from the shapes of its apertures, which do not affect an f-number.
pub(crate) fn is_round_but_for_apertures(lens: &Lens) -> bool {
    let mut plain = lens.clone();
    plain.elements.iter_mut().for_each(|element| element.apertures.clear());
    plain.has_axis_of_revolution()
}

impl Optics {
    /// Returns the fraction of the light of an axial object at infinity, within the entrance pupil of `marginal`, that reaches
    /// the image. It includes losses at coatings and mirrors, in glass, and at a central obstruction. If the lens is not round
    /// about its axis, the fraction refers to the rays that pass. If `marginal` is `None`, the result is the transmittance along
    /// the axis.
    ///
    /// # Errors
    /// A medium has no usable index.
    pub fn axial_transmittance(&self, indices: Indices, marginal: Option<MarginalRay>) -> Result<f64, DispersionError> {
        let tracer = self.tracer(indices)?;
        let radius_mm = marginal.map_or(0.0, |ray| ray.height_mm);
        let round = self.has_axis_of_revolution();
        let spokes = if round { 1 } else { SPOKES };
        let mut rays = RayBatch::new(RINGS * spokes);
        rays.restart(RINGS * spokes);
        let wavelength_nm = match indices {
            Indices::At(nm) => nm,
            Indices::Band { .. } | Indices::Stated => self.reference_nm,
        };
        let c = rays.columns_mut();
        for i in 0..RINGS * spokes {
            // Rings and spokes of equal area.
            let r = radius_mm * (((i / spokes) as f64 + 0.5) / RINGS as f64).sqrt();
            let (sin, cos) = math::sin_cos_turns(((i % spokes) as f64 + 0.5) / spokes as f64);
            (c.x[i], c.y[i], c.z[i]) = (if round { 0.0 } else { r * cos }, if round { r } else { r * sin }, 0.0);
            (c.l[i], c.m[i], c.n[i]) = (0.0, 0.0, 1.0);
            c.wavelength_nm[i] = wavelength_nm;
        }
        tracer.trace(&mut rays, &mut tracer.work_in_place(RINGS * spokes), Travel::Forward);
        let (mut sum, mut passed) = (0.0, 0);
        for (weight, state) in rays.weights().iter().zip(rays.states()) {
            if *state == ALIVE {
                sum += weight;
                passed += 1;
            }
        }
        Ok(sum / if round { RINGS as f64 } else { f64::from(passed.max(1)) })
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
