//! `kind: tilted-plane`: a plane that is not perpendicular to the axis; the surfaces behind it stay on the old axis.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::{cos, sin};
use spectra_core::params::{Angle, Faults, Params};
use spectra_core::registry::Context;
use spectra_core::surface::{Hit, Kernel, KernelShape, Ray, Real, Surface};

/// A plane through the vertex, turned by two right-handed rotations: by `tilt-x` about x, then by `tilt-y` about the new y axis.
/// Its sag is z = y tan(tilt-x) - x tan(tilt-y) / cos(tilt-x). A positive tilt about x moves the upper part to larger z.
///
/// In a lens file, `{kind: tilted-plane, tilt-x: 30, thickness: 20, glass: SCHOTT/N-SF11}` is the face of a prism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltedPlane {
    /// Unit normal, toward +z.
    normal: [f64; 3],
}

impl TiltedPlane {
    /// Creates a plane with tilts about x and y, in rad. Each must be less than a right angle.
    #[must_use]
    pub fn new(tilt_x_rad: f64, tilt_y_rad: f64) -> Self {
        let (sx, cx, sy, cy) = (sin(tilt_x_rad), cos(tilt_x_rad), sin(tilt_y_rad), cos(tilt_y_rad));
        Self { normal: [sy, -(sx * cy), cx * cy] }
    }
}

impl KernelShape for TiltedPlane {
    fn scaled(&self, _factor: f64) -> Option<Self> {
        Some(*self)
    }

    #[inline(always)]
    fn hit<R: Real, const FORWARD: bool>(&self, ray: Ray<R, FORWARD>) -> Hit<R> {
        let [a, b, c] = self.normal.map(R::constant);
        let ([x, y, z], [l, m, n]) = (ray.position, ray.direction);
        let cosine = l * a + m * b + n * c;
        let height = x * a + y * b + z * c;
        // A ray along the plane never meets it: subtracting makes a cosine of 0 invalid.
        Hit { distance: -height / cosine, cosine, valid: ray.along(cosine) - R::constant(f64::MIN_POSITIVE) }
    }

    #[inline(always)]
    fn normal<R: Real>(&self, _: [R; 3]) -> [R; 3] {
        self.normal.map(R::constant)
    }

    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        let [a, b, c] = self.normal;
        Some(-(a * x_mm + b * y_mm) / c)
    }

    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        (0.0, 0.0)
    }
}

/// A plane that is not perpendicular to the axis.
///
/// Use it for the face of a prism or of a tilted plate if the surfaces behind it stay on the old axis. The tilt is part of
/// the shape here, unlike `tilt`, which turns any surface about its vertex, and `coordinate-break`, which turns
/// everything behind it. The plane goes through the vertex and is turned right-handed, first about x, then about the y
/// axis that was turned with it: z = y tan(tilt-x) - x tan(tilt-y) / cos(tilt-x).
///
/// # Example
/// ```yaml
/// # The first face of a 60 degree prism
/// {kind: tilted-plane, tilt-x: 30 deg, thickness: 20, glass: SCHOTT/N-SF11, semi-diameter: 20}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct TiltedPlaneParams {
    /// Rotation about x, degrees if bare, between -90 and 90: positive moves the upper part to larger z.
    #[serde(default = "no_tilt")]
    #[schemars(extend("exclusiveMinimum" = -90, "exclusiveMaximum" = 90))]
    tilt_x: Angle,
    /// Rotation about the y axis after the first rotation, degrees if bare, between -90 and 90: positive moves the part at
    /// +x to smaller z.
    #[serde(default = "no_tilt")]
    #[schemars(extend("exclusiveMinimum" = -90, "exclusiveMaximum" = 90))]
    tilt_y: Angle,
}

fn no_tilt() -> Angle {
    Angle::from_rad(0.0)
}

spectra_core::register!(surface "tilted-plane": TiltedPlaneParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    let p: TiltedPlaneParams = params.parse()?;
    Ok(Box::new(Kernel(TiltedPlane::new(p.tilt_x.rad(), p.tilt_y.rad()))))
}
