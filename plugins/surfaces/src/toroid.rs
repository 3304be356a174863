//! `kind: toroid`: a curve in the y-z plane, rotated about an axis parallel to y.

use crate::shared::{self, ConicSection, MOST_COEFFICIENTS, polynomial, scaled_powers};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, LengthOrInfinity, Params};
use spectra_core::registry::Context;
use spectra_core::surface::{FromSag, PerRay, SagShape, Surface};

/// A toroid: the curve z = g(y) = conic sag + a2 y^2 + a4 y^4 + ..., rotated about a line. The line is parallel to y at
/// z = R = `rotation-radius`, so the surface is (R - z)^2 + x^2 = (R - g(y))^2. If R is infinite, the curve is shifted
/// along x.
///
/// In a lens file: `{kind: toroid, radius: 40, rotation-radius: 55, thickness: 4, glass: SCHOTT/N-BK7}`.
#[derive(Clone, Debug, PartialEq)]
pub struct Toroid {
    section: ConicSection,
    /// Coefficients 0, a2, a4, ... of the powers of y^2.
    coefficients: Vec<f64>,
    rotation_per_mm: f64,
}

impl Toroid {
    /// Creates a toroid from its curve in the y-z plane and its axis of rotation. The curve has the radius `radius_mm`, the conic
    /// constant `conic`, and `coefficients` a2, a4, ... in mm^(1 - power). `rotation_radius_mm` is the distance of the axis from
    /// the vertex, positive if the axis lies at larger z.
    #[must_use]
    pub fn new(radius_mm: f64, conic: f64, coefficients: &[f64], rotation_radius_mm: f64) -> Self {
        Self {
            section: ConicSection::new(1.0 / radius_mm, conic),
            coefficients: std::iter::once(0.0).chain(coefficients.iter().copied()).collect(),
            rotation_per_mm: 1.0 / rotation_radius_mm,
        }
    }

    /// Returns the sag of the curve at `y` (both in mm) and its derivative. `None` beyond the rim of the conic part.
    fn curve(&self, y: f64) -> Option<(f64, f64)> {
        let (sag, slope) = self.section.sag_and_slope(y * y)?;
        let (p, dp) = polynomial(&self.coefficients, y * y);
        Some((sag + p, 2.0 * y * (slope + dp)))
    }

    /// Returns g, g', 1 / (R v) and w at (x, y). With v = 1 - g / R and w = sqrt(1 - x^2 / (R v)^2) the surface is
    /// z = g + x^2 / (R v (1 + w)). `None` beyond the axis of rotation (v < 0), where there is no surface.
    fn parts(&self, x: f64, y: f64) -> Option<(f64, f64, f64, f64)> {
        let (g, dg) = self.curve(y)?;
        let v = 1.0 - g * self.rotation_per_mm;
        let around = self.rotation_per_mm / v;
        let square = 1.0 - x * x * around * around;
        (v > 0.0 && square >= 0.0).then(|| (g, dg, around, square.sqrt()))
    }
}

impl SagShape for Toroid {
    fn scaled(&self, factor: f64) -> Option<Self> {
        Some(Self {
            section: self.section.scaled(factor),
            coefficients: scaled_powers(&self.coefficients, 0, 2, factor),
            rotation_per_mm: self.rotation_per_mm / factor,
        })
    }

    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        let (g, _, around, root) = self.parts(x_mm, y_mm)?;
        Some(g + x_mm * x_mm * around / (1.0 + root))
    }

    /// Uses the implicit form: dz/dx = x / (R - z), dz/dy = g' (R - g) / (R - z), and R - z = (R - g) w.
    fn slope(&self, x_mm: f64, y_mm: f64) -> Option<(f64, f64)> {
        let (_, dg, around, root) = self.parts(x_mm, y_mm)?;
        Some((x_mm * around / root, dg / root))
    }

    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        let a2 = self.coefficients.get(1).copied().unwrap_or(0.0);
        (self.rotation_per_mm, self.section.curvature_per_mm + 2.0 * a2)
    }
}

/// A curve in the y-z plane, rotated about an axis parallel to y.
///
/// Use it for anamorphic and astigmatic elements: barrels, tires and their aspheric variants. The curve is z = g(y) = c y^2 /
/// (1 + sqrt(1 - (1 + k) c^2 y^2)) + a2 y^2 + a4 y^4 + ..., with c = 1 / radius; rotated about the line at z = R =
/// `rotation-radius` it is (R - z)^2 + x^2 = (R - g(y))^2. With R = inf it is shifted along x instead of rotated: a
/// cylinder whose section is the curve.
///
/// `radius` belongs to the y-z section, `rotation-radius` to the x-z section at the vertex. Both are positive if their
/// centers lie at larger z. There is no surface beyond the axis of rotation.
///
/// # Example
/// ```yaml
/// {kind: toroid, radius: 40, rotation-radius: 55, thickness: 4, glass: SCHOTT/N-BK7, semi-diameter: 15}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ToroidParams {
    /// Radius of the curve in the y-z plane, mm if bare, not 0: positive if its center lies at larger z; `inf` is
    /// straight.
    radius: LengthOrInfinity,
    /// Conic constant k of the curve, any number: 0 is a circle.
    #[serde(default)]
    conic: f64,
    /// Coefficients a2, a4, ... of the curve, in mm^(1 - power), from that of y^2 on. At most 20; missing ones are 0.
    #[serde(default)]
    #[schemars(length(max = MOST_COEFFICIENTS))]
    coefficients: Vec<f64>,
    /// Distance from the vertex to the point where the axis of rotation crosses the z axis, mm if bare, not 0: positive at
    /// larger z. With `inf` the surface is not curved along x.
    rotation_radius: LengthOrInfinity,
}

spectra_core::register!(surface "toroid": ToroidParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    let p: ToroidParams = params.parse()?;
    let mut faults = Faults::new();
    shared::curvature(params, "radius", p.radius, &mut faults);
    shared::curvature(params, "rotation-radius", p.rotation_radius, &mut faults);
    let toroid = Toroid::new(p.radius.mm(), p.conic, &p.coefficients, p.rotation_radius.mm());
    faults.into_result(Box::new(PerRay(FromSag(toroid))) as Box<dyn Surface>)
}
