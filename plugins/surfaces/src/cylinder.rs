//! `kind: cylinder`: a circular cylinder, curved in one section only.

use crate::shared;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, LengthOrInfinity, Params};
use spectra_core::registry::Context;
use spectra_core::surface::{Hit, Kernel, KernelShape, Ray, Real, Surface};

/// A circular cylinder. The straight lines on it run along x or y; its section across them is a circle.
///
/// In a lens file, `{kind: cylinder, radius: 80, axis: y, thickness: 4, glass: SCHOTT/N-BK7}` has power in the x-z plane.
///
/// Only the half that contains the vertex belongs to the surface. A ray meets the surface where it crosses it in the
/// direction of travel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Curvature in the x-z section, 1/mm.
    x_per_mm: f64,
    /// Curvature in the y-z section, 1/mm. One of the two is 0.
    y_per_mm: f64,
}

/// The axis along which the straight lines of a [`Cylinder`] run.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum CylinderAxis {
    /// The lines run along x: the surface is curved in the y-z plane.
    X,
    /// The lines run along y: the surface is curved in the x-z plane.
    Y,
}

impl Cylinder {
    /// Creates a cylinder of this radius, mm: positive if its axis lies at larger z, infinite for a plane.
    #[must_use]
    pub fn new(radius_mm: f64, axis: CylinderAxis) -> Self {
        let c = 1.0 / radius_mm;
        match axis {
            CylinderAxis::X => Self { x_per_mm: 0.0, y_per_mm: c },
            CylinderAxis::Y => Self { x_per_mm: c, y_per_mm: 0.0 },
        }
    }
}

impl KernelShape for Cylinder {
    fn scaled(&self, factor: f64) -> Option<Self> {
        Some(Self { x_per_mm: self.x_per_mm / factor, y_per_mm: self.y_per_mm / factor })
    }

    /// Starts at the point of the ray nearest to the vertex. Then solves as for the sphere, but without the coordinate along the
    /// axis. The surface is c x^2 + d y^2 + (c + d) z^2 - 2 z = 0 with the curvatures c and d of the two sections, one of which is 0.
    #[inline(always)]
    fn hit<R: Real, const FORWARD: bool>(&self, ray: Ray<R, FORWARD>) -> Hit<R> {
        let (cx, cy) = (R::constant(self.x_per_mm), R::constant(self.y_per_mm));
        let c = R::constant(self.x_per_mm + self.y_per_mm);
        let ([x, y, z], [l, m, n]) = (ray.position, ray.direction);
        let near = -(x * l + y * m + z * n);
        let (x, y, z) = (x + near * l, y + near * m, z + near * n);
        let (cx_l, cy_m, c_n) = (cx * l, cy * m, c * n);
        let a = (cx_l * l + cy_m * m) + c_n * n;
        let b = n - ((cx_l * x + cy_m * y) + c_n * z);
        let q = (cx * x * x + cy * y * y) + c * z * z - (z + z);
        let discriminant = b * b - a * q;
        let cosine = ray.along(discriminant.sqrt());
        let distance = q / (b + cosine);
        let on_vertex_half = R::constant(1.0) - c * (z + distance * n);
        Hit { distance: near + distance, cosine, valid: discriminant.min(on_vertex_half) }
    }

    #[inline(always)]
    fn normal<R: Real>(&self, [x, y, z]: [R; 3]) -> [R; 3] {
        let c = R::constant(self.x_per_mm + self.y_per_mm);
        [-(R::constant(self.x_per_mm) * x), -(R::constant(self.y_per_mm) * y), R::constant(1.0) - c * z]
    }

    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        let (cx, cy) = (self.x_per_mm, self.y_per_mm);
        let square = 1.0 - cx * cx * x_mm * x_mm - cy * cy * y_mm * y_mm;
        (square >= 0.0).then(|| (cx * x_mm * x_mm + cy * y_mm * y_mm) / (1.0 + square.sqrt()))
    }

    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        (self.x_per_mm, self.y_per_mm)
    }
}

/// A circular cylinder, with power in one section only.
///
/// Use it for anamorphic attachments and line foci. Its section across the `axis` is a circle of the stated radius; along
/// the axis it is straight. Only the half that contains the vertex belongs to the surface. A tilt about z, such as
/// `tilt: [0, 0, 30 deg]`, turns the axis to any angle.
///
/// # Example
/// ```yaml
/// # Power in the x-z section, which stretches or squeezes the picture horizontally
/// {kind: cylinder, radius: 80, axis: y, thickness: 4, glass: SCHOTT/N-BK7, semi-diameter: 20}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct CylinderParams {
    /// Radius, mm if bare, not 0: positive if the axis of the cylinder lies at larger z; `inf` is a plane.
    radius: LengthOrInfinity,
    /// Direction of the straight lines on the surface, `x` or `y`: with `x` it is curved in the y-z plane.
    axis: CylinderAxis,
}

spectra_core::register!(surface "cylinder": CylinderParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    let p: CylinderParams = params.parse()?;
    let mut faults = Faults::new();
    shared::curvature(params, "radius", p.radius, &mut faults);
    faults.into_result(Box::new(Kernel(Cylinder::new(p.radius.mm(), p.axis))) as Box<dyn Surface>)
}
