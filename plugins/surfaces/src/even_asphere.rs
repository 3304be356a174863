//! `kind: even-asphere`: a conic with a polynomial in even powers of the radius on top.

use crate::conic::Conic;
use crate::shared::{self, ConicSection, MOST_COEFFICIENTS};
use glam::DVec3;
use serde::Deserialize;
use spectra_core::params::{Faults, LengthOrInfinity, Params};
use spectra_core::registry::{Context, SurfaceEntry};
use spectra_core::surface::{Hit, Kernel, KernelShape, Ray, Real, Surface, Travel, nearest_crossing};

/// z = conic sag + a2 r^2 + a4 r^4 + ..., with up to `TERMS` coefficients: the sizes are compiled apart, so that the
/// polynomial is straight code.
///
/// In a lens file: `{kind: even-asphere, radius: 12.3, conic: -0.8, coefficients: [0, 1.2e-5, -3e-8], glass: SCHOTT/N-BK7}`.
///
/// With u = z - polynomial(r^2) the surface is c (r^2 + (1 + k) u^2) - 2 u = 0: no square root, so steps of Newton's
/// method cost one division each. They start where the ray meets a conic that fits at the vertex. Rays for which four
/// steps do not plainly lead home go to [`nearest_crossing`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvenAsphere<const TERMS: usize> {
    section: ConicSection,
    /// Where the steps start.
    start: ConicSection,
    /// a2, a4, ...
    coefficients: [f64; TERMS],
}

/// Sizes of [`EvenAsphere`] that are compiled.
const SIZES: [usize; 3] = [4, 8, MOST_COEFFICIENTS];

impl<const TERMS: usize> EvenAsphere<TERMS> {
    /// An asphere of this radius of curvature, mm, conic constant, and coefficients a2, a4, ... in mm^(1 - power).
    ///
    /// # Panics
    /// If there are more coefficients than `TERMS`.
    #[must_use]
    pub fn new(radius_mm: f64, conic: f64, coefficients: &[f64]) -> Self {
        let section = ConicSection::new(1.0 / radius_mm, conic);
        let mut all = [0.0; TERMS];
        all[..coefficients.len()].copy_from_slice(coefficients);
        // The curvature at the vertex is the whole one; the rim is not nearer than that of the conic part.
        let (c, whole) = (section.curvature_per_mm, section.curvature_per_mm + 2.0 * all[0]);
        let ratio = c / whole;
        let one_plus_conic = if ratio > 0.0 { section.one_plus_conic * ratio * ratio * ratio.min(1.0) } else { 0.0 };
        Self { section, start: ConicSection { curvature_per_mm: whole, one_plus_conic }, coefficients: all }
    }

    /// The polynomial at a square of the radius, and its derivative by that.
    #[inline(always)]
    fn polynomial<R: Real>(&self, radius2: R) -> (R, R) {
        let a = &self.coefficients;
        let (mut value, mut slope) = (R::constant(a[TERMS - 1]), R::constant(0.0));
        for i in (0..TERMS - 1).rev() {
            slope = slope * radius2 + value;
            value = value * radius2 + R::constant(a[i]);
        }
        (radius2 * value, value + radius2 * slope)
    }

    /// At a distance along a ray: Newton's step, the derivative that it divides by (direction . normal), and the z
    /// component of the conic part's normal, which is negative on the wrong sheet.
    #[inline(always)]
    fn step<R: Real>(&self, [x, y, z]: [R; 3], [l, m, n]: [R; 3], t: R) -> (R, R, R) {
        let c = R::constant(self.section.curvature_per_mm);
        let one = R::constant(1.0);
        let (x, y, z) = (x + t * l, y + t * m, z + t * n);
        let radius2 = x * x + y * y;
        let outward = x * l + y * m;
        let (p, dp) = self.polynomial(radius2);
        let u = z - p;
        let sheet = one - c * (R::constant(self.section.one_plus_conic) * u);
        let value = R::constant(0.5) * (u * (one + sheet) - c * radius2);
        let slope = sheet * (n - (dp + dp) * outward) - c * outward;
        (value / slope, slope, sheet)
    }

    /// Sag, and its derivative by the square of the radius.
    fn sag_and_slope(&self, radius2: f64) -> Option<(f64, f64)> {
        let (sag, slope) = self.section.sag_and_slope(radius2)?;
        let (p, dp) = self.polynomial(radius2);
        Some((sag + p, slope + dp))
    }
}

/// A step may be this part of the one before: see [`nearest_crossing`].
const SHORTER: f64 = 0.4;
/// Steps below this, mm, may be rounding.
const NOISE_MM: f64 = 1e-11;
/// What the last step but one left, mm, must be so small that the last one, which gains as many digits again, leaves
/// nothing.
const LAST_MM: f64 = 1e-7;

impl<const TERMS: usize> KernelShape for EvenAsphere<TERMS> {
    const UNIT_NORMAL: bool = false;
    const SEARCHES: bool = true;

    #[inline(always)]
    fn hit<R: Real, const FORWARD: bool>(&self, ray: Ray<R, FORWARD>) -> Hit<R> {
        let start = Conic::of_section(self.start).hit(ray);
        let (p, d) = (ray.position, ray.direction);
        let t = start.distance;
        let (step1, _, _) = self.step(p, d, t);
        let t = t - step1;
        let (step2, _, _) = self.step(p, d, t);
        let t = t - step2;
        let (step3, _, _) = self.step(p, d, t);
        let t = t - step3;
        let (step4, slope, sheet) = self.step(p, d, t);
        let t = t - step4;
        let shorter = |step: R, last: R| R::constant(SHORTER) * last.abs() + R::constant(NOISE_MM) - step.abs();
        // NaN, once in, reaches the last step, and `min` passes it on from there.
        let valid = sheet
            .min(ray.along(slope))
            .min(shorter(step2, step1))
            .min(shorter(step3, step2))
            .min(shorter(step4, step3))
            .min(R::constant(LAST_MM) - step4.abs());
        Hit { distance: valid.choose(t, R::constant(0.0)), cosine: slope, valid }
    }

    #[inline(always)]
    fn normal<R: Real>(&self, [x, y, z]: [R; 3]) -> [R; 3] {
        let c = R::constant(self.section.curvature_per_mm);
        let (p, dp) = self.polynomial(x * x + y * y);
        let sheet = R::constant(1.0) - c * (R::constant(self.section.one_plus_conic) * (z - p));
        let across = c + (dp + dp) * sheet;
        [-(across * x), -(across * y), sheet]
    }

    fn search(&self, position: [f64; 3], direction: [f64; 3], travel: Travel) -> Option<f64> {
        let (p, d) = (DVec3::from(position), DVec3::from(direction));
        let to_plane = -p.z / d.z;
        let to_plane = if to_plane.is_finite() { to_plane } else { 0.0 };
        let origin = p + to_plane * d;
        let height = |t: f64| {
            let q = origin + t * d;
            let (sag, slope) = self.sag_and_slope(q.x * q.x + q.y * q.y)?;
            Some((q.z - sag, d.z - 2.0 * slope * (q.x * d.x + q.y * d.y)))
        };
        Some(to_plane + nearest_crossing(height, origin, d, travel, 0.0)?)
    }

    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        self.sag_and_slope(x_mm * x_mm + y_mm * y_mm).map(|(sag, _)| sag)
    }

    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        (self.start.curvature_per_mm, self.start.curvature_per_mm)
    }
}

/// Parameters of `kind: even-asphere` as written in a lens.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct EvenAsphereParams {
    /// Radius of curvature of the conic part, mm if bare: positive where the center lies at larger z; `inf` is none.
    radius: LengthOrInfinity,
    /// Conic constant.
    #[serde(default)]
    conic: f64,
    /// a2, a4, a6, ... in mm^(1 - power): the first is that of r^2. At most 20.
    coefficients: Vec<f64>,
}

inventory::submit! {
    SurfaceEntry::new("even-asphere", "A conic with a polynomial in even powers of the radius on top.", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"), build)
}

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    let p: EvenAsphereParams = params.parse()?;
    let mut faults = Faults::new();
    let c = shared::curvature(params, "radius", p.radius, &mut faults);
    shared::finite(params, "conic", p.conic, &mut faults);
    shared::coefficients(params, &p.coefficients, MOST_COEFFICIENTS, &mut faults);
    if !faults.is_empty() {
        return Err(faults);
    }
    let used = p.coefficients.iter().rposition(|a| *a != 0.0).map_or(0, |last| last + 1);
    let a = &p.coefficients[..used];
    let (radius, conic) = (p.radius.mm(), p.conic);
    Ok(match used {
        0 => Box::new(Kernel(Conic::of_curvature(c, conic))),
        n if n <= SIZES[0] => Box::new(Kernel(EvenAsphere::<{ SIZES[0] }>::new(radius, conic, a))),
        n if n <= SIZES[1] => Box::new(Kernel(EvenAsphere::<{ SIZES[1] }>::new(radius, conic, a))),
        _ => Box::new(Kernel(EvenAsphere::<{ SIZES[2] }>::new(radius, conic, a))),
    })
}
