//! `kind: thin-lens`: an ideal lens without thickness.

use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::Loss;
use spectra_core::params::{Faults, Length, Params};
use spectra_core::registry::Context;
use spectra_core::surface::{Action, Bending, BentRay, Intersection, PerRay, ScalarShape, Surface};

/// An ideal lens: it images every plane perpendicular to the axis sharply and to scale, n'/s' = n/s + 1/f at any angle.
/// With u the slope of a ray against the axis and h its height on the lens, n' u' = n u - h / f.
///
/// In a lens file: `{kind: thin-lens, focal-length: 50, semi-diameter: 12, thickness: 50}`. With `mirror: true` it is an
/// ideal mirror of that focal length, positive if it converges light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    power_per_mm: f64,
}

impl ThinLens {
    /// Creates an ideal lens of this focal length in air, mm. A positive one converges light, and an infinite one has no effect.
    #[must_use]
    pub fn new(focal_length_mm: f64) -> Self {
        Self { power_per_mm: 1.0 / focal_length_mm }
    }
}

impl ScalarShape for ThinLens {
    fn scaled(&self, factor: f64) -> Option<Self> {
        Some(Self { power_per_mm: self.power_per_mm / factor })
    }

    fn intersect(&self, position: DVec3, direction: DVec3) -> Option<Intersection> {
        (direction.z != 0.0)
            .then(|| Intersection { distance_mm: -position.z / direction.z, normal: DVec3::new(0.0, 0.0, 1.0) })
    }

    fn sag_mm(&self, _: f64, _: f64) -> Option<f64> {
        Some(0.0)
    }

    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        (0.0, 0.0)
    }

    fn paraxial_power_per_mm(&self, _: f64, _: f64) -> (f64, f64) {
        (self.power_per_mm, self.power_per_mm)
    }

    fn redirect(&self, at: &Bending) -> Option<Result<DVec3, Loss>> {
        // Slopes are measured along the light, so that a lens converges it in either direction of travel.
        let along = at.direction.z.abs();
        let (after, sense) = match at.action {
            Action::Reflect => (at.n_before, -at.direction.z.signum()),
            _ => (at.n_after, at.direction.z.signum()),
        };
        let slope = |cosine: f64, h: f64| (at.n_before * cosine / along - h * self.power_per_mm) / after;
        let (u, v) = (slope(at.direction.x, at.point.x), slope(at.direction.y, at.point.y));
        Some(Ok(DVec3::new(u, v, sense).normalize()))
    }

    fn has_phase(&self) -> bool {
        true
    }

    /// Returns the phase that makes all paths equal to the one through the center. The paths run from a point of the plane that the
    /// lens is focused on to its image.
    fn phase_mm(&self, ray: &BentRay) -> f64 {
        let image_mm = ray.n_after / (self.power_per_mm - ray.n_before / ray.object_mm);
        ray.n_before * Self::shorter_mm(ray.point, -ray.before, ray.object_mm)
            + ray.n_after * Self::shorter_mm(ray.point, ray.after, image_mm)
    }
}

impl ThinLens {
    /// Returns by how much the path to a point is longer from the center of the lens than from `place`, mm. The point lies
    /// along `toward` from `place`, at this depth (mm along the axis). A negative depth means the other side of the lens, where
    /// path lengths count as negative.
    fn shorter_mm(place: DVec3, toward: DVec3, depth_mm: f64) -> f64 {
        if depth_mm.is_infinite() {
            return toward.dot(place);
        }
        let aside = toward * (depth_mm / toward.z.abs());
        let ways = (place + aside).length() + aside.length();
        // The difference of two squared lengths over the sum of the lengths: exact for distant points, too.
        let difference = (2.0 * aside.dot(place) + place.length_squared()) / ways;
        if ways > 0.0 { difference * depth_mm.signum() } else { 0.0 }
    }
}

/// An ideal lens without thickness or aberration.
///
/// Use it for a first layout, an idealized relay or eyepiece, or a test. It images every plane perpendicular to the axis
/// sharply and to scale, n'/s' = n/s + 1/f, at any angle. With u the slope of a ray against the axis and h its height on
/// the lens, n' u' = n u - h / f. The focal length is the same at all wavelengths.
///
/// Its optical path, in `lens trace` and for diffraction, is a convention, since no lens is ideal for all distances at once.
/// Take a point at the focus distance (infinity if the lens is not focused), as imaged by the surfaces in front of the thin
/// lens. All paths from that point to its image are equal.
///
/// It has no glass of its own: the medium behind it is air unless you write `glass`. With `mirror: true` it is an ideal
/// mirror, with a positive focal length if it converges light. It has no coating and no Fresnel losses.
///
/// # Example
/// ```yaml
/// {kind: thin-lens, focal-length: 50 mm, thickness: 50, semi-diameter: 12}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ThinLensParams {
    /// Focal length in air, mm if bare, not 0: a positive one converges light.
    focal_length: Length,
}

spectra_core::register!(surface "thin-lens": ThinLensParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    let p: ThinLensParams = params.parse()?;
    if p.focal_length.mm() == 0.0 {
        return Err(params.fault("focal-length", "a lens cannot have a focal length of 0").into());
    }
    Ok(Box::new(PerRay(ThinLens::new(p.focal_length.mm()))))
}
