//! `kind: odd-asphere`: a conic plus a polynomial in all powers of the radius.

use crate::shared::{self, ConicSection, MOST_COEFFICIENTS, polynomial, scaled_powers};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, LengthOrInfinity, Params};
use spectra_core::registry::Context;
use spectra_core::surface::{FromSag, PerRay, SagShape, Surface};

/// An odd asphere, with the sag z = conic sag + a1 r + a2 r^2 + a3 r^3 + .... The term a1 makes it a cone (an axicon) at the
/// vertex.
///
/// In a lens file, `{kind: odd-asphere, radius: inf, coefficients: [0.05], glass: SCHOTT/N-BK7}` is an axicon.
#[derive(Clone, Debug, PartialEq)]
pub struct OddAsphere {
    section: ConicSection,
    /// Coefficients 0, a1, a2, ..., in mm^(1 - power).
    coefficients: Vec<f64>,
}

impl OddAsphere {
    /// Creates an asphere from its radius of curvature (mm), its conic constant, and its coefficients a1, a2, ... in mm^(1 -
    /// power).
    #[must_use]
    pub fn new(radius_mm: f64, conic: f64, coefficients: &[f64]) -> Self {
        let coefficients = std::iter::once(0.0).chain(coefficients.iter().copied()).collect();
        Self { section: ConicSection::new(1.0 / radius_mm, conic), coefficients }
    }
}

impl SagShape for OddAsphere {
    fn scaled(&self, factor: f64) -> Option<Self> {
        let coefficients = scaled_powers(&self.coefficients, 0, 1, factor);
        Some(Self { section: self.section.scaled(factor), coefficients })
    }

    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        let radius2 = x_mm * x_mm + y_mm * y_mm;
        Some(self.section.sag_mm(radius2)? + polynomial(&self.coefficients, radius2.sqrt()).0)
    }

    fn slope(&self, x_mm: f64, y_mm: f64) -> Option<(f64, f64)> {
        let radius2 = x_mm * x_mm + y_mm * y_mm;
        let (_, conic) = self.section.sag_and_slope(radius2)?;
        let radius = radius2.sqrt();
        // The slope is not defined at the tip of a cone. By symmetry the tip is treated as flat.
        let odd = if radius > 0.0 { polynomial(&self.coefficients, radius).1 / radius } else { 0.0 };
        let along = 2.0 * conic + odd;
        Some((along * x_mm, along * y_mm))
    }

    /// Leaves out the term a1, whose curvature at the vertex is infinite.
    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        let c = self.section.curvature_per_mm + 2.0 * self.coefficients.get(2).copied().unwrap_or(0.0);
        (c, c)
    }
}

/// A conic plus a polynomial in all powers of the radius.
///
/// Use it for axicons and for prescriptions with odd powers. Its sag is z = c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)) + a1
/// r + a2 r^2 + a3 r^3 + ..., with the curvature c = 1 / radius, the conic constant k and `coefficients: [a1, a2, a3,
/// ...]`.
///
/// If a1 is not 0, the vertex is the tip of a cone. A ray that hits the tip itself meets a flat surface, and the
/// paraxial figures of the lens ignore a1. If you need only even powers, use `kind: even-asphere`, which is faster.
///
/// # Example
/// ```yaml
/// # An axicon, a cone of glass that focuses a beam to a line along the axis
/// {kind: odd-asphere, radius: inf, coefficients: [0.05], thickness: 5, glass: SCHOTT/N-BK7, semi-diameter: 12.7}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct OddAsphereParams {
    /// Radius of curvature of the conic part, mm if bare, not 0: positive if the center lies at larger z; `inf` means no
    /// curvature.
    radius: LengthOrInfinity,
    /// Conic constant k, any number: 0 is a sphere.
    #[serde(default)]
    conic: f64,
    /// Coefficients a1, a2, a3, ... in mm^(1 - power), from that of r on. At most 20; missing ones are 0.
    #[schemars(length(max = MOST_COEFFICIENTS))]
    coefficients: Vec<f64>,
}

spectra_core::register!(surface "odd-asphere": OddAsphereParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    let p: OddAsphereParams = params.parse()?;
    let mut faults = Faults::new();
    shared::curvature(params, "radius", p.radius, &mut faults);
    let asphere = OddAsphere::new(p.radius.mm(), p.conic, &p.coefficients);
    faults.into_result(Box::new(PerRay(FromSag(asphere))) as Box<dyn Surface>)
}
