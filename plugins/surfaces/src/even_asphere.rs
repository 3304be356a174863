//! `kind: even-asphere`: a conic plus a polynomial in even powers of the radius.

use crate::conic::Conic;
use crate::shared::{self, ConicSection, MOST_COEFFICIENTS};
use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, LengthOrInfinity, Params};
use spectra_core::registry::Context;
use spectra_core::surface::{Hit, Kernel, KernelShape, Near, Ray, Real, Surface, Travel, nearest_crossing};

/// An even asphere, with the sag z = conic sag + a2 r^2 + a4 r^4 + ... and at most `TERMS` coefficients. The code is compiled for
/// each value of `TERMS`, so that the polynomial needs no loop.
///
/// In a lens file: `{kind: even-asphere, radius: 12.3, conic: -0.8, coefficients: [0, 1.2e-5, -3e-8], glass: SCHOTT/N-BK7}`.
///
/// With u = z - polynomial(r^2) the surface is c (r^2 + (1 + k) u^2) - 2 u = 0, without a square root. The iteration starts where
/// the ray meets a conic that fits at the vertex.
///
/// The first two steps are those of Ostrowski's method, which reaches fourth order with one slope and two heights (A. M.
/// Ostrowski, Solution of Equations and Systems of Equations, 1966, chapter 11). Newton steps follow; mostly one is enough, and
/// the last one also yields the normal. A ray for which these steps do not clearly converge is passed to [`nearest_crossing`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvenAsphere<const TERMS: usize> {
    section: ConicSection,
    /// Conic that fits at the vertex, where the steps start.
    start: ConicSection,
    /// Coefficients a2, a4, ..., in mm^(1 - power).
    coefficients: [f64; TERMS],
    /// Coefficients a2, 2 a4, 3 a6, ... of the derivative with respect to the square of the radius.
    slopes: [f64; TERMS],
}

/// Values of `TERMS` for which [`EvenAsphere`] is compiled.
const SIZES: [usize; 3] = [4, 8, MOST_COEFFICIENTS];

impl<const TERMS: usize> EvenAsphere<TERMS> {
    /// Creates an asphere from its radius of curvature (mm), its conic constant, and its coefficients a2, a4, ... in mm^(1 -
    /// power).
    ///
    /// # Panics
    /// Panics if there are more coefficients than `TERMS`.
    #[must_use]
    pub fn new(radius_mm: f64, conic: f64, coefficients: &[f64]) -> Self {
        let section = ConicSection::new(1.0 / radius_mm, conic);
        let mut all = [0.0; TERMS];
        all[..coefficients.len()].copy_from_slice(coefficients);
        // The starting conic has the total curvature at the vertex, and its rim is at least as far out as that of the conic part.
        let (c, whole) = (section.curvature_per_mm, section.curvature_per_mm + 2.0 * all[0]);
        let ratio = c / whole;
        let one_plus_conic = if ratio > 0.0 { section.one_plus_conic * ratio * ratio * ratio.min(1.0) } else { 0.0 };
        Self {
            section,
            start: ConicSection { curvature_per_mm: whole, one_plus_conic },
            coefficients: all,
            slopes: std::array::from_fn(|i| (i + 1) as f64 * all[i]),
        }
    }

    /// Returns the polynomial at a squared radius, and its derivative with respect to the squared radius.
    #[inline(always)]
    fn polynomial<R: Real>(&self, radius2: R) -> (R, R) {
        (radius2 * sum(&self.coefficients, radius2), sum(&self.slopes, radius2))
    }

    /// Returns the height function u - c (r^2 + (1 + k) u^2) / 2 at a squared radius and u, and the z component of the conic part's
    /// normal. The height function is zero on the surface; near it, it is half the height above the surface times the length of the
    /// gradient. The z component is negative on the wrong sheet.
    #[inline(always)]
    fn height<R: Real>(&self, radius2: R, u: R) -> (R, R) {
        let c = R::constant(self.section.curvature_per_mm);
        let one = R::constant(1.0);
        let sheet = one - R::constant(self.section.curvature_per_mm * self.section.one_plus_conic) * u;
        (R::constant(0.5) * (u * (one + sheet) - c * radius2), sheet)
    }

    /// Returns, at the distance `t` along a ray, the height function, its derivative along the ray (direction . normal), and the two
    /// numbers that give the normal.
    #[inline(always)]
    fn height_and_slope<R: Real>(&self, [x, y, z]: [R; 3], [l, m, n]: [R; 3], t: R) -> (R, R, [R; 2]) {
        let (x, y, z) = (x + t * l, y + t * m, z + t * n);
        let radius2 = x * x + y * y;
        let (p, dp) = self.polynomial(radius2);
        let (value, sheet) = self.height(radius2, z - p);
        let across = R::constant(self.section.curvature_per_mm) + (dp + dp) * sheet;
        (value, sheet * n - across * (x * l + y * m), [across, sheet])
    }

    /// Returns the sag (mm) and its derivative with respect to the squared radius (1/mm). `None` beyond the rim.
    fn sag_and_slope(&self, radius2: f64) -> Option<(f64, f64)> {
        let (sag, slope) = self.section.sag_and_slope(radius2)?;
        let (p, dp) = self.polynomial(radius2);
        Some((sag + p, slope + dp))
    }
}

/// Evaluates a0 + a1 x + a2 x^2 + .... The even and the odd terms are summed separately in powers of x^2, which makes two short
/// chains of operations instead of a long one.
#[inline(always)]
fn sum<R: Real, const TERMS: usize>(a: &[f64; TERMS], x: R) -> R {
    const { assert!(TERMS.is_multiple_of(2) && TERMS >= 2) };
    let x2 = x * x;
    let (mut even, mut odd) = (R::constant(a[TERMS - 2]), R::constant(a[TERMS - 1]));
    for i in (0..TERMS / 2 - 1).rev() {
        even = even * x2 + R::constant(a[2 * i]);
        odd = odd * x2 + R::constant(a[2 * i + 1]);
    }
    even + x * odd
}

/// Largest ratio of a step to the one before it that still counts as converging: see [`nearest_crossing`].
const SHORTER: f64 = 0.4;
/// Steps shorter than this, in mm, may be rounding errors.
const NOISE_MM: f64 = 1e-11;
/// A ray has arrived once a step, in mm, is at most this plus [`ROUNDINGS`] times the distance along the ray. The normal is then
/// right, too.
const ARRIVED_MM: f64 = 1e-13;
/// Rounding error that is allowed in a step, as a fraction of the distance along the ray.
const ROUNDINGS: f64 = 4.0 * f64::EPSILON;
/// The second step is Ostrowski's only if the first one was longer than this, in mm. Otherwise its divisor may be pure rounding
/// error, so the step uses the slope of the first one.
const PLAIN_MM: f64 = 1e-6;
/// The second step is Ostrowski's only if the first one left at most this fraction of the height. Otherwise its divisor may be a poor
/// estimate of the slope, and the step uses the slope of the first one.
const PLAIN: f64 = 0.1;

/// Returns a number that is not negative if a step is clearly shorter than the last one.
#[inline(always)]
fn shorter<R: Real>(step: R, last: R) -> R {
    R::constant(SHORTER) * last + R::constant(NOISE_MM) - step.abs()
}

impl<const TERMS: usize> KernelShape for EvenAsphere<TERMS> {
    fn scaled(&self, factor: f64) -> Option<Self> {
        let coefficients = shared::scaled_powers(&self.coefficients, 2, 2, factor);
        let radius_mm = factor / self.section.curvature_per_mm;
        Some(Self::new(radius_mm, self.section.one_plus_conic - 1.0, &coefficients))
    }

    const UNIT_NORMAL: bool = false;
    const SEARCHES: bool = true;
    const STEPS: bool = true;

    #[inline(always)]
    fn hit<R: Real, const FORWARD: bool>(&self, ray: Ray<R, FORWARD>) -> Hit<R> {
        Hit { valid: R::constant(1.0), ..Conic::of_section(self.start).hit(ray) }
    }

    /// Takes a Newton step. Keeps the step and the inverse of the slope.
    #[inline(always)]
    fn approach<R: Real, const FORWARD: bool>(&self, ray: Ray<R, FORWARD>, hit: Hit<R>) -> Near<R> {
        let (value, slope, _) = self.height_and_slope(ray.position, ray.direction, hit.distance);
        let inverse = R::constant(1.0) / slope;
        let step = value * inverse;
        Near { distance: hit.distance - step, kept: [step, inverse], step: step.abs(), valid: hit.valid }
    }

    /// Takes Ostrowski's step h1 h0 / (h0 - 2 h1), where h0 and h1 are the heights before and now, both divided by the first slope.
    #[inline(always)]
    fn correct<R: Real, const FORWARD: bool>(&self, ray: Ray<R, FORWARD>, near: Near<R>) -> Near<R> {
        let ([x, y, z], [l, m, n], t) = (ray.position, ray.direction, near.distance);
        let (x, y, z) = (x + t * l, y + t * m, z + t * n);
        let radius2 = x * x + y * y;
        let [before, inverse] = near.kept;
        let here = self.height(radius2, z - radius2 * sum(&self.coefficients, radius2)).0 * inverse;
        let plain = (R::constant(PLAIN) * near.step - here.abs()).min(near.step - R::constant(PLAIN_MM));
        let step = here * plain.choose(before / (before - (here + here)), R::constant(1.0));
        Near { distance: t - step, step: step.abs(), valid: near.valid.min(shorter(step, near.step)), ..near }
    }

    /// Takes a Newton step. Keeps the two numbers that give the normal.
    #[inline(always)]
    fn settle<R: Real, const FORWARD: bool>(&self, ray: Ray<R, FORWARD>, near: Near<R>) -> Near<R> {
        let (value, slope, kept) = self.height_and_slope(ray.position, ray.direction, near.distance);
        let step = value / slope;
        let rounding = R::constant(ARRIVED_MM) + R::constant(ROUNDINGS) * near.distance.abs();
        // A NaN persists up to the last step, and `min` passes it on from there.
        let valid = near.valid.min(kept[1]).min(ray.along(slope)).min(shorter(step, near.step));
        let left = (rounding - step.abs()).choose(R::constant(0.0), step.abs());
        Near { distance: near.distance - step, kept, step: left, valid }
    }

    #[inline(always)]
    fn keep<R: Real>(&self, [x, y, z]: [R; 3]) -> [R; 2] {
        let radius2 = x * x + y * y;
        let (p, dp) = self.polynomial(radius2);
        let (_, sheet) = self.height(radius2, z - p);
        [R::constant(self.section.curvature_per_mm) + (dp + dp) * sheet, sheet]
    }

    #[inline(always)]
    fn normal_kept<R: Real>(&self, [x, y, _]: [R; 3], [across, sheet]: [R; 2]) -> [R; 3] {
        [-(across * x), -(across * y), sheet]
    }

    #[inline(always)]
    fn normal<R: Real>(&self, point: [R; 3]) -> [R; 3] {
        self.normal_kept(point, self.keep(point))
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

/// A conic plus a polynomial in even powers of the radius.
///
/// This is the usual asphere of molded and polished lenses. Its sag is z = c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)) + a2 r^2 +
/// a4 r^4 + a6 r^6 + ..., with the curvature c = 1 / radius, the conic constant k and `coefficients: [a2, a4, a6,
/// ...]`.
///
/// The first coefficient is that of r^2. Patents mostly begin with the fourth power: write a 0 before it. Lengths are
/// in millimeters, so a_n has the unit mm^(1 - n). A prescription scaled by s has the coefficients a_n / s^(n - 1).
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
    /// Radius of curvature of the conic part, mm if bare, not 0: positive if the center lies at larger z; `inf` means no
    /// curvature.
    radius: LengthOrInfinity,
    /// Conic constant k, any number: 0 is a sphere.
    #[serde(default)]
    conic: f64,
    /// Coefficients a2, a4, a6, ... in mm^(1 - power), from that of r^2 on. At most 20; missing ones are 0.
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
