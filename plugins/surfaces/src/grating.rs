//! `kind: grating`: a diffraction grating ruled on a sphere or a plane.

use crate::sphere::Sphere;
use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::Loss;
use spectra_core::math::{cos, sin};
use spectra_core::params::{Angle, Faults, LengthOrInfinity, Params, SpatialFrequency};
use spectra_core::registry::Context;
use spectra_core::surface::{Action, Bending, BentRay, Intersection, KernelShape, PerRay, Ray, ScalarShape, Surface};

const MM_PER_NM: f64 = 1e-6;

/// A diffraction grating on a sphere. Its lines lie in parallel planes along the axis, equally spaced on the vertex plane.
///
/// In a lens file, `{kind: grating, lines-per-mm: 600, order: 1, mirror: true, thickness: -100}` is a plane reflection
/// grating whose first order goes up.
///
/// In the tangent plane of the surface the direction changes by n' d' - n d = order x wavelength x G (G. H. Spencer and
/// M. V. R. K. Murty, "General ray-tracing procedure", J. Opt. Soc. Am. 52, 672 (1962)). G has the length `lines-per-mm`
/// and points across the lines: along +y for `direction: 0`, turned by `direction` right-handed about +z (90 is -x).
/// Order 1 turns light toward G. All light goes into the one order. An order that does not exist, because its sine would
/// exceed 1, counts as totally reflected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grating {
    sphere: Sphere,
    /// Vector across the lines whose length is the order times the lines per mm, 1/mm.
    order_lines_per_mm: DVec3,
}

impl Grating {
    /// Creates a grating for one `order` on a sphere of this radius, mm (infinite for a plane). `direction_rad` turns the direction
    /// across the lines from +y, right-handed about +z.
    #[must_use]
    pub fn new(lines_per_mm: f64, order: i32, radius_mm: f64, direction_rad: f64) -> Self {
        let size = f64::from(order) * lines_per_mm;
        let across = DVec3::new(-size * sin(direction_rad), size * cos(direction_rad), 0.0);
        Self { sphere: Sphere::new(radius_mm), order_lines_per_mm: across }
    }
}

impl ScalarShape for Grating {
    fn scaled(&self, factor: f64) -> Option<Self> {
        Some(Self { sphere: KernelShape::scaled(&self.sphere, factor)?, ..*self })
    }

    fn intersect(&self, position: DVec3, direction: DVec3) -> Option<Intersection> {
        let (p, d) = (position.to_array(), direction.to_array());
        let radius2 = p[0] * p[0] + p[1] * p[1];
        let hit = if direction.z >= 0.0 {
            self.sphere.hit(Ray::<f64, true> { position: p, direction: d, radius2 })
        } else {
            self.sphere.hit(Ray::<f64, false> { position: p, direction: d, radius2 })
        };
        let point = position + hit.distance * direction;
        (hit.valid >= 0.0)
            .then(|| Intersection { distance_mm: hit.distance, normal: self.sphere.normal(point.to_array()).into() })
    }

    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        KernelShape::sag_mm(&self.sphere, x_mm, y_mm)
    }

    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        KernelShape::vertex_curvature_per_mm(&self.sphere)
    }

    fn is_directional(&self) -> bool {
        self.order_lines_per_mm != DVec3::ZERO
    }

    fn redirect(&self, at: &Bending) -> Option<Result<DVec3, Loss>> {
        let n_after = if at.action == Action::Reflect { at.n_before } else { at.n_after };
        let turned = at.n_before * at.direction + at.wavelength_nm * MM_PER_NM * self.order_lines_per_mm;
        let tangential = (turned - turned.dot(at.normal) * at.normal) / n_after;
        let square = 1.0 - tangential.length_squared();
        if !(square >= 0.0) {
            return Some(Err(Loss::TotalReflection));
        }
        let away = if at.action == Action::Reflect { -square.sqrt() } else { square.sqrt() };
        Some(Ok(tangential + away * at.normal))
    }

    fn has_phase(&self) -> bool {
        true
    }

    fn phase_mm(&self, ray: &BentRay) -> f64 {
        ray.wavelength_nm * MM_PER_NM * self.order_lines_per_mm.dot(ray.point)
    }
}

/// A diffraction grating, plane or on a sphere, in one order.
///
/// Use it for spectrographs and diffractive elements, in transmission or, with `mirror: true`, in reflection. The lines
/// lie in parallel planes along the axis, equally spaced on the vertex plane. In the tangent plane of the surface the
/// direction changes by n' d' - n d = order x wavelength x G, where G has the length `lines-per-mm` and points across
/// the lines: order 1 turns light toward G.
///
/// All light goes into the one order: blaze and diffraction efficiency are not modeled. An order that does not exist,
/// because its sine would exceed 1, counts as totally reflected.
///
/// # Example
/// ```yaml
/// # A plane reflection grating whose first order goes up
/// {kind: grating, lines-per-mm: 600, order: 1, thickness: -100, mirror: true, semi-diameter: 12}
/// ```
/// ```yaml
/// # A transmission grating on a window
/// {kind: grating, lines-per-mm: 300 lines/mm, order: -1, thickness: 3, glass: SCHOTT/N-BK7, semi-diameter: 12}
/// ```
/// # References
/// - G. H. Spencer and M. V. R. K. Murty, "General ray-tracing procedure", J. Opt. Soc. Am. 52, 672 (1962).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct GratingParams {
    /// Number of lines per millimeter, 1/mm if bare, such as `600 lines/mm`; zero or more.
    lines_per_mm: spectra_core::params::NonNegative<SpatialFrequency>,
    /// Diffraction order, of any sign; 0 is the undiffracted light.
    order: i32,
    /// Radius of the ruled sphere, mm if bare, not 0: positive if the center lies at larger z; a plane if left out.
    #[serde(default = "plane")]
    radius: LengthOrInfinity,
    /// Direction across the lines, degrees if bare, right-handed about +z from +y: 0 turns order 1 toward +y, 90 toward
    /// -x.
    #[serde(default = "upward")]
    direction: Angle,
}

fn plane() -> LengthOrInfinity {
    LengthOrInfinity::Infinite
}

fn upward() -> Angle {
    Angle::from_rad(0.0)
}

spectra_core::register!(surface "grating": GratingParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    let p: GratingParams = params.parse()?;
    let mut faults = Faults::new();
    crate::shared::curvature(params, "radius", p.radius, &mut faults);
    let grating = Grating::new(p.lines_per_mm.per_mm(), p.order, p.radius.mm(), p.direction.rad());
    faults.into_result(Box::new(PerRay(grating)) as Box<dyn Surface>)
}
