//! `kind: thin-lens`: an ideal lens without thickness.

use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::Loss;
use spectra_core::params::{Faults, Length, Params};
use spectra_core::registry::Context;
use spectra_core::surface::{Action, Bending, BentRay, Intersection, PerRay, ScalarShape, Surface};

/// An ideal lens: every plane across the axis is imaged sharp and to scale, n'/s' = n/s + 1/f at any angle. With u the
/// slope against the axis and h the place on the lens, n' u' = n u - h / f.
///
/// In a lens file: `{kind: thin-lens, focal-length: 50, semi-diameter: 12, thickness: 50}`. With `mirror: true` it is an
/// ideal mirror of that focal length, positive where it gathers light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    power_per_mm: f64,
}

impl ThinLens {
    /// A lens of this focal length in air, mm: positive gathers light; infinite does nothing.
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
        // Slopes count along the light, so that a lens gathers it in either sense.
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

    /// What makes all paths from a point of the plane that the lens is focused on to its image as long as the one through the center.
    fn phase_mm(&self, ray: &BentRay) -> f64 {
        let image_mm = ray.n_after / (self.power_per_mm - ray.n_before / ray.object_mm);
        ray.n_before * Self::shorter_mm(ray.point, -ray.before, ray.object_mm)
            + ray.n_after * Self::shorter_mm(ray.point, ray.after, image_mm)
    }
}

impl ThinLens {
    /// By how much the way from the center to a point is longer than that from a place on the lens, mm: the point lies along
    /// `toward` from the place, at this depth (mm along the axis; negative for a point on the other side, whose ways are negative).
    fn shorter_mm(place: DVec3, toward: DVec3, depth_mm: f64) -> f64 {
        if depth_mm.is_infinite() {
            return toward.dot(place);
        }
        let aside = toward * (depth_mm / toward.z.abs());
        let ways = (place + aside).length() + aside.length();
        // The difference of the squares of two lengths over their sum: exact for far points, too.
        let difference = (2.0 * aside.dot(place) + place.length_squared()) / ways;
        if ways > 0.0 { difference * depth_mm.signum() } else { 0.0 }
    }
}

/// An ideal lens without thickness or aberration.
///
/// For a first layout, for an idealized relay or eyepiece, for tests. Every plane across the axis is imaged sharp and
/// to scale, n'/s' = n/s + 1/f, at any angle: with u the slope of a ray against the axis and h its height on the lens,
/// n' u' = n u - h / f. The focal length is the same at all wavelengths.
///
/// Its optical path, in `lens trace` and for diffraction, is a convention, since no lens is ideal for all distances at once: all paths
/// from a point at the distance that the lens is focused at (infinity if it is not focused), as what stands before images it, to the
/// image are equal.
///
/// It has no glass of its own: what stands behind it is air unless `glass` says otherwise. With `mirror: true` it is an
/// ideal mirror, with a positive focal length if it converges light. Coatings and Fresnel losses skip it.
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
        return Err(params.fault("focal-length", "a focal length of 0 is no lens").into());
    }
    Ok(Box::new(PerRay(ThinLens::new(p.focal_length.mm()))))
}
