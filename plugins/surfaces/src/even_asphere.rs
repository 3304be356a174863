//! `kind: even-asphere`: a conic with a polynomial in even powers of the radius on top.

use crate::conic::Conic;
use crate::shared::{self, ConicSection, MOST_COEFFICIENTS};
use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, LengthOrInfinity, Params};
use spectra_core::registry::Context;
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

    /// The polynomial at a square of the radius, and its derivative by that. Terms of even and of odd place are summed
    /// apart, by the fourth power of the radius: two short chains of operations instead of a long one.
    #[inline(always)]
    fn polynomial<R: Real>(&self, radius2: R) -> (R, R) {
        let (even, odd, even_slope, odd_slope) = self.halves(radius2 * radius2);
        let value = even + radius2 * odd;
        let slope = odd + (radius2 + radius2) * (even_slope + radius2 * odd_slope);
        (radius2 * value, value + radius2 * slope)
    }

    /// a2 + a6 x + ..., a4 + a8 x + ..., and their derivatives.
    #[inline(always)]
    fn halves<R: Real>(&self, x: R) -> (R, R, R, R) {
        const { assert!(TERMS.is_multiple_of(2) && TERMS >= 2) };
        let a = &self.coefficients;
        let zero = R::constant(0.0);
        let (mut even, mut even_slope) = (R::constant(a[TERMS - 2]), zero);
        let (mut odd, mut odd_slope) = (R::constant(a[TERMS - 1]), zero);
        for i in (0..TERMS / 2 - 1).rev() {
            even_slope = even_slope * x + even;
            odd_slope = odd_slope * x + odd;
            even = even * x + R::constant(a[2 * i]);
            odd = odd * x + R::constant(a[2 * i + 1]);
        }
        (even, odd, even_slope, odd_slope)
    }

    /// At a distance along a ray: height over the surface (zero on it), its derivative along the ray (direction .
    /// normal), and the z component of the conic part's normal, which is negative on the wrong sheet.
    #[inline(always)]
    fn height<R: Real>(&self, [x, y, z]: [R; 3], [l, m, n]: [R; 3], t: R) -> (R, R, R) {
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
        (value, slope, sheet)
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
/// The last step leaves about its size times its ratio to the one before, mm: at most this.
const LEFT_MM: f64 = 1e-14;

/// Not negative where a step is well below the size of the last one.
#[inline(always)]
fn shorter<R: Real>(step: R, last: R) -> R {
    R::constant(SHORTER) * last + R::constant(NOISE_MM) - step.abs()
}

impl<const TERMS: usize> KernelShape for EvenAsphere<TERMS> {
    const UNIT_NORMAL: bool = false;
    const SEARCHES: bool = true;

    /// Three steps of Newton's method, the third with one more behind it.
    const ROUNDS: usize = 2;

    /// The first guess.
    #[inline(always)]
    fn hit<R: Real, const FORWARD: bool>(&self, ray: Ray<R, FORWARD>) -> Hit<R> {
        let start = Conic::of_section(self.start).hit(ray);
        // `cosine` carries the size of the last step.
        Hit { distance: start.distance, cosine: R::constant(f64::INFINITY), valid: R::constant(1.0) }
    }

    #[inline(always)]
    fn refine<R: Real, const FORWARD: bool>(&self, ray: Ray<R, FORWARD>, hit: Hit<R>) -> Hit<R> {
        let (value, slope, _) = self.height(ray.position, ray.direction, hit.distance);
        let step = value / slope;
        Hit { distance: hit.distance - step, cosine: step.abs(), valid: hit.valid.min(shorter(step, hit.cosine)) }
    }

    #[inline(always)]
    fn finish<R: Real, const FORWARD: bool>(&self, ray: Ray<R, FORWARD>, hit: Hit<R>) -> Hit<R> {
        let (p, d, t) = (ray.position, ray.direction, hit.distance);
        let (value, slope, _) = self.height(p, d, t);
        let inverse = R::constant(1.0) / slope;
        let step = value * inverse;
        let t = t - step;
        // The last step takes the slope from the one before, which is right to the digits that it needs.
        let (value, _, sheet) = self.height(p, d, t);
        let last = value * inverse;
        let t = t - last;
        // NaN, once in, reaches the last step, and `min` passes it on from there.
        let valid = (hit.valid.min(shorter(step, hit.cosine)))
            .min(sheet)
            .min(ray.along(slope))
            .min(R::constant(LEFT_MM) * step.abs() + R::constant(NOISE_MM * NOISE_MM) - last * last);
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

/// A conic with a polynomial in even powers of the radius on top.
///
/// The usual asphere of molded and polished lenses. Its sag is z = c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)) + a2 r^2 +
/// a4 r^4 + a6 r^6 + ..., with the curvature c = 1 / radius, the conic constant k and `coefficients: [a2, a4, a6,
/// ...]`.
///
/// The first coefficient is that of r^2. Patents mostly begin with the fourth power: write a 0 before it. Lengths are
/// in millimeters, so an has the unit mm^(1 - n); a prescription that is scaled by s has coefficients an / s^(n - 1).
///
/// # Example
/// ```yaml
/// kind: even-asphere
/// radius: 12.3
/// conic: -0.8
/// coefficients: [0, 1.2e-5, -3e-8]
/// thickness: 3
/// glass: SCHOTT/N-BK7
/// semi-diameter: 6
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct EvenAsphereParams {
    /// Radius of curvature of the conic part, mm if bare, not 0: positive where the center lies at larger z; `inf` is
    /// none.
    radius: LengthOrInfinity,
    /// Conic constant k, any number: 0 is a sphere.
    #[serde(default)]
    conic: f64,
    /// a2, a4, a6, ... in mm^(1 - power): the first is that of r^2. At most 20; missing ones are 0.
    #[schemars(length(max = MOST_COEFFICIENTS))]
    coefficients: Vec<f64>,
}

spectra_core::register!(surface "even-asphere": EvenAsphereParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    let p: EvenAsphereParams = params.parse()?;
    let mut faults = Faults::new();
    let c = shared::curvature(params, "radius", p.radius, &mut faults);
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
