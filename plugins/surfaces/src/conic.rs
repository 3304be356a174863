//! `kind: conic`: a conic section rotated about the axis.

use crate::shared::{self, ConicSection};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, LengthOrInfinity, Params};
use spectra_core::registry::Context;
use spectra_core::surface::{Hit, Kernel, KernelShape, Ray, Real, Surface};

/// A conic of revolution, with the sag z = c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)), the curvature c = 1 / radius and the
/// conic constant k: a hyperboloid below k = -1, a paraboloid at -1, an ellipsoid above (prolate below 0, a sphere at 0,
/// oblate above 0).
///
/// In a lens file, `{kind: conic, radius: -200, conic: -1, mirror: true, thickness: -100}` is a parabolic mirror.
///
/// Only the sheet of a hyperboloid, or the half of an ellipsoid, that contains the vertex belongs to the surface. A ray
/// meets the surface where it crosses it in the direction of travel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conic {
    section: ConicSection,
}

impl Conic {
    /// Creates a conic of this radius of curvature at the vertex, mm (positive if the center lies at larger z, infinite
    /// for a plane), and this conic constant.
    #[must_use]
    pub fn new(radius_mm: f64, conic: f64) -> Self {
        Self::of_curvature(1.0 / radius_mm, conic)
    }

    #[inline(always)]
    pub(crate) fn of_section(section: ConicSection) -> Self {
        Self { section }
    }

    pub(crate) fn of_curvature(curvature_per_mm: f64, conic: f64) -> Self {
        Self { section: ConicSection::new(curvature_per_mm, conic) }
    }
}

impl KernelShape for Conic {
    fn scaled(&self, factor: f64) -> Option<Self> {
        Some(Self { section: self.section.scaled(factor) })
    }

    /// The normal is minus half the gradient of c (r^2 + (1 + k) z^2) - 2 z, which has unit length only on spheres.
    const UNIT_NORMAL: bool = false;

    /// Starts at the point of the ray nearest to the vertex, since a distant source would cost digits. Then solves, as for the
    /// sphere, a t^2 - 2 b t + q = 0 with a = c (1 + k n^2), b = n - c (x l + y m + (1 + k) z n) and
    /// q = c (r^2 + (1 + k) z^2) - 2 z. The root t = q / (b + sqrt(b^2 - a q)) is the one where the ray crosses in the
    /// direction of travel.
    #[inline(always)]
    fn hit<R: Real, const FORWARD: bool>(&self, ray: Ray<R, FORWARD>) -> Hit<R> {
        let c = R::constant(self.section.curvature_per_mm);
        let flat = R::constant(self.section.one_plus_conic);
        let ([x, y, z], [l, m, n]) = (ray.position, ray.direction);
        let near = -(x * l + y * m + z * n);
        let (x, y, z) = (x + near * l, y + near * m, z + near * n);
        let (flat_z, flat_n) = (flat * z, flat * n);
        let a = c * ((l * l + m * m) + flat_n * n);
        let b = n - c * ((x * l + y * m) + flat_z * n);
        let q = c * ((x * x + y * y) + flat_z * z) - (z + z);
        let discriminant = b * b - a * q;
        let cosine = ray.along(discriminant.sqrt());
        let distance = q / (b + cosine);
        // On the other half of an ellipsoid, or the other sheet of a hyperboloid, the normal would point to -z.
        let on_vertex_sheet = R::constant(1.0) - c * (flat_z + flat_n * distance);
        Hit { distance: near + distance, cosine, valid: discriminant.min(on_vertex_sheet) }
    }

    #[inline(always)]
    fn normal<R: Real>(&self, [x, y, z]: [R; 3]) -> [R; 3] {
        let c = R::constant(self.section.curvature_per_mm);
        [-(c * x), -(c * y), R::constant(1.0) - c * (R::constant(self.section.one_plus_conic) * z)]
    }

    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        self.section.sag_mm(x_mm * x_mm + y_mm * y_mm)
    }

    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        (self.section.curvature_per_mm, self.section.curvature_per_mm)
    }
}

/// A conic section rotated about the axis.
///
/// Use it for telescope mirrors, for aspheres without higher terms, and for anything that images one point perfectly onto
/// another. Its sag is z = c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)) with the curvature c = 1 / radius and the conic
/// constant k: a hyperboloid below k = -1, a paraboloid at -1, a prolate ellipsoid from there to 0, a sphere at 0, an
/// oblate ellipsoid above.
///
/// Only the half of an ellipsoid, or the sheet of a hyperboloid, that contains the vertex belongs to the surface.
///
/// # Example
/// ```yaml
/// # A parabolic mirror of 100 mm focal length
/// {kind: conic, radius: -200, conic: -1, thickness: -100, mirror: true, semi-diameter: 25}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ConicParams {
    /// Radius of curvature at the vertex, mm if bare, not 0: positive if the center lies at larger z; `inf` is a
    /// plane.
    radius: LengthOrInfinity,
    /// Conic constant k, any number: 0 is a sphere, -1 a paraboloid.
    conic: f64,
}

spectra_core::register!(surface "conic": ConicParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    let p: ConicParams = params.parse()?;
    let mut faults = Faults::new();
    let c = shared::curvature(params, "radius", p.radius, &mut faults);
    faults.into_result(Box::new(Kernel(Conic::of_curvature(c, p.conic))) as Box<dyn Surface>)
}
