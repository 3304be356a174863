//! `kind: biconic`: a surface with different conic sections in the x-z and the y-z plane.

use crate::shared;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, LengthOrInfinity, Params};
use spectra_core::registry::Context;
use spectra_core::surface::{FromSag, PerRay, SagShape, Surface};

/// A biconic surface. Its sag is z = (cx x^2 + cy y^2) / (1 + sqrt(1 - (1 + kx) cx^2 x^2 - (1 + ky) cy^2 y^2)), with the
/// curvatures cx, cy and the conic constants kx, ky of the x-z and y-z sections.
///
/// In a lens file: `{kind: biconic, radius-x: 50, radius-y: 60, conic-x: -0.5, thickness: 5, glass: SCHOTT/N-BK7}`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Biconic {
    curvature_per_mm: (f64, f64),
    one_plus_conic: (f64, f64),
}

impl Biconic {
    /// Creates a biconic from its two radii at the vertex (mm) and its two conic constants, each in the order x-z section, y-z
    /// section.
    #[must_use]
    pub fn new(radius_mm: (f64, f64), conic: (f64, f64)) -> Self {
        Self {
            curvature_per_mm: (1.0 / radius_mm.0, 1.0 / radius_mm.1),
            one_plus_conic: (1.0 + conic.0, 1.0 + conic.1),
        }
    }

    /// Returns the numerator of the sag and the square root in its denominator; `None` beyond the rim.
    fn parts(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        let ((cx, cy), (kx, ky)) = (self.curvature_per_mm, self.one_plus_conic);
        let square = 1.0 - kx * cx * cx * x * x - ky * cy * cy * y * y;
        (square >= 0.0).then(|| (cx * x * x + cy * y * y, square.sqrt()))
    }
}

impl SagShape for Biconic {
    fn scaled(&self, factor: f64) -> Option<Self> {
        let (x, y) = self.curvature_per_mm;
        Some(Self { curvature_per_mm: (x / factor, y / factor), ..*self })
    }

    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        self.parts(x_mm, y_mm).map(|(numerator, root)| numerator / (1.0 + root))
    }

    fn slope(&self, x_mm: f64, y_mm: f64) -> Option<(f64, f64)> {
        let (numerator, root) = self.parts(x_mm, y_mm)?;
        let below = 1.0 + root;
        let along = |v: f64, c: f64, k: f64| c * v * (2.0 + numerator * k * c / (below * root)) / below;
        let ((cx, cy), (kx, ky)) = (self.curvature_per_mm, self.one_plus_conic);
        Some((along(x_mm, cx, kx), along(y_mm, cy, ky)))
    }

    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        self.curvature_per_mm
    }
}

/// A surface with different conic sections along x and along y.
///
/// Use it for astigmatic surfaces with a different radius and conic constant in the x-z and in the y-z section. Its sag is
/// z = (cx x^2 + cy y^2) / (1 + sqrt(1 - (1 + kx) cx^2 x^2 - (1 + ky) cy^2 y^2)), with cx = 1 / `radius-x` and so on.
/// Unlike a toroid, it is not a surface of revolution.
///
/// # Example
/// ```yaml
/// kind: biconic
/// radius-x: 50
/// radius-y: 60
/// conic-x: -0.5
/// thickness: 5
/// glass: SCHOTT/N-BK7
/// semi-diameter: 15
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct BiconicParams {
    /// Radius in the x-z section, mm if bare, not 0: positive if the center lies at larger z; `inf` is straight.
    radius_x: LengthOrInfinity,
    /// Radius in the y-z section, mm if bare, not 0: positive if the center lies at larger z; `inf` is straight.
    radius_y: LengthOrInfinity,
    /// Conic constant of the x-z section, any number: 0 is a circle.
    #[serde(default)]
    conic_x: f64,
    /// Conic constant of the y-z section, any number: 0 is a circle.
    #[serde(default)]
    conic_y: f64,
}

spectra_core::register!(surface "biconic": BiconicParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    let p: BiconicParams = params.parse()?;
    let mut faults = Faults::new();
    shared::curvature(params, "radius-x", p.radius_x, &mut faults);
    shared::curvature(params, "radius-y", p.radius_y, &mut faults);
    let biconic = Biconic::new((p.radius_x.mm(), p.radius_y.mm()), (p.conic_x, p.conic_y));
    faults.into_result(Box::new(PerRay(FromSag(biconic))) as Box<dyn Surface>)
}
