//! `kind: zernike`: a conic plus Zernike polynomials.

use crate::shared::{self, ConicSection, polynomial};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Faults, Length, LengthOrInfinity, Params, Positive};
use spectra_core::registry::Context;
use spectra_core::surface::{FromSag, PerRay, SagShape, Surface};

/// Largest number of coefficients: radial orders up to 14 in Noll's order.
const MOST: usize = 120;

/// A Zernike surface, with the sag z = conic sag + sum of c_j Z_j(x / R, y / R) for the normalization radius R. Angles are
/// measured from +x toward +y.
///
/// In a lens file: `{kind: zernike, radius: 100, normalization-radius: 12, coefficients: [0, 0, 0, 2e-4], ordering: fringe}`.
///
/// The polynomials continue beyond the normalization radius. In the order `noll` each has a mean square of 1 over the disk
/// (R. J. Noll, "Zernike polynomials and atmospheric turbulence", J. Opt. Soc. Am. 66, 207 (1976)). In the order `fringe`,
/// that of the University of Arizona, each is 1 at the rim (J. C. Wyant and K. Creath, "Basic wavefront aberration theory",
/// Applied Optics and Optical Engineering XI (1992)), continued by the same rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Zernike {
    section: ConicSection,
    per_mm: f64,
    /// Polynomials in (r/R)^2 that multiply Re (x + i y)^m and Im (x + i y)^m, for each azimuthal order m.
    orders: Vec<[Vec<f64>; 2]>,
}

/// Order and normalization of the polynomials of a [`Zernike`].
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum ZernikeOrdering {
    /// Noll's order, with a mean square of 1.
    Noll,
    /// The Fringe or University of Arizona order, with the value 1 at the rim.
    Fringe,
}

/// Returns, for polynomial `j` (from 1), the radial order n, the azimuthal order m, whether it has the sine, and the factor of the
/// radial polynomial.
fn term(ordering: ZernikeOrdering, j: u32) -> (u32, u32, bool, f64) {
    match ordering {
        ZernikeOrdering::Noll => {
            let mut n = 0;
            while (n + 1) * (n + 2) / 2 < j {
                n += 1;
            }
            // Index within the radial order, from 0; |m| rises by 2 at every second index.
            let place = j - n * (n + 1) / 2 - 1;
            let m = if n % 2 == 0 { 2 * place.div_ceil(2) } else { 2 * (place / 2) + 1 };
            let size = if m == 0 { f64::from(n + 1) } else { f64::from(2 * (n + 1)) };
            (n, m, m != 0 && j % 2 == 1, size.sqrt())
        }
        ZernikeOrdering::Fringe => {
            // Group g holds (n + m) / 2 = g, at j from g^2 + 1 to (g + 1)^2; m falls from g to 0, cosine before sine.
            let mut g = 0;
            while (g + 1) * (g + 1) < j {
                g += 1;
            }
            let place = j - g * g - 1;
            let m = g - place / 2;
            (2 * g - m, m, m != 0 && place % 2 == 1, 1.0)
        }
    }
}

/// Returns the coefficients of the radial polynomial of orders n, m in powers of rho^2, without its factor rho^m.
fn radial(n: u32, m: u32) -> Vec<f64> {
    let factorial = |k: u32| (1..=k).map(f64::from).product::<f64>();
    let top = (n - m) / 2;
    let mut powers = vec![0.0; top as usize + 1];
    for s in 0..=top {
        let size = factorial(n - s) / (factorial(s) * factorial((n + m) / 2 - s) * factorial(top - s));
        powers[(top - s) as usize] = if s % 2 == 0 { size } else { -size };
    }
    powers
}

impl Zernike {
    /// Creates a surface from its conic part and its Zernike part. The conic part has the radius at the vertex `radius_mm` and
    /// the conic constant `conic`. The Zernike part has `coefficients` from j = 1 on, in mm of sag, and its own normalization
    /// radius. `ordering` says which polynomial each j means.
    #[must_use]
    pub fn new(
        radius_mm: f64,
        conic: f64,
        normalization_radius_mm: f64,
        coefficients: &[f64],
        ordering: ZernikeOrdering,
    ) -> Self {
        let mut orders: Vec<[Vec<f64>; 2]> = Vec::new();
        for (j, c) in (1..).zip(coefficients) {
            if *c == 0.0 {
                continue;
            }
            let (n, m, sine, factor) = term(ordering, j);
            if orders.len() <= m as usize {
                orders.resize(m as usize + 1, [Vec::new(), Vec::new()]);
            }
            let sum = &mut orders[m as usize][usize::from(sine)];
            let powers = radial(n, m);
            if sum.len() < powers.len() {
                sum.resize(powers.len(), 0.0);
            }
            for (sum, power) in sum.iter_mut().zip(powers) {
                *sum += c * factor * power;
            }
        }
        Self { section: ConicSection::new(1.0 / radius_mm, conic), per_mm: 1.0 / normalization_radius_mm, orders }
    }

    /// Returns the sum of the polynomials (mm) and its derivatives at the point (`x`, `y`), whose unit is the normalization
    /// radius.
    fn sum(&self, x: f64, y: f64) -> (f64, f64, f64) {
        let radius2 = x * x + y * y;
        let (mut value, mut by_x, mut by_y) = (0.0, 0.0, 0.0);
        // (x + i y)^m and its derivative m (x + i y)^(m - 1).
        let (mut re, mut im) = (1.0, 0.0);
        let (mut slope_re, mut slope_im) = (0.0, 0.0);
        for (m, [cosine, sine]) in self.orders.iter().enumerate() {
            let ((a, da), (b, db)) = (polynomial(cosine, radius2), polynomial(sine, radius2));
            value += a * re + b * im;
            let along = 2.0 * (da * re + db * im);
            by_x += along * x + a * slope_re + b * slope_im;
            by_y += along * y - a * slope_im + b * slope_re;
            let order = (m + 1) as f64;
            (slope_re, slope_im) = (order * re, order * im);
            (re, im) = (re * x - im * y, re * y + im * x);
        }
        (value, by_x, by_y)
    }
}

impl SagShape for Zernike {
    fn scaled(&self, factor: f64) -> Option<Self> {
        let times = |sum: &Vec<f64>| sum.iter().map(|c| c * factor).collect();
        Some(Self {
            section: self.section.scaled(factor),
            per_mm: self.per_mm / factor,
            orders: self.orders.iter().map(|both| both.each_ref().map(times)).collect(),
        })
    }

    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        let conic = self.section.sag_mm(x_mm * x_mm + y_mm * y_mm)?;
        Some(conic + self.sum(x_mm * self.per_mm, y_mm * self.per_mm).0)
    }

    fn slope(&self, x_mm: f64, y_mm: f64) -> Option<(f64, f64)> {
        self.sag_and_slope(x_mm, y_mm).map(|(_, slope)| slope)
    }

    fn sag_and_slope(&self, x_mm: f64, y_mm: f64) -> Option<(f64, (f64, f64))> {
        let (sag, conic) = self.section.sag_and_slope(x_mm * x_mm + y_mm * y_mm)?;
        let (sum, by_x, by_y) = self.sum(x_mm * self.per_mm, y_mm * self.per_mm);
        let slope = (2.0 * conic * x_mm + by_x * self.per_mm, 2.0 * conic * y_mm + by_y * self.per_mm);
        Some((sag + sum, slope))
    }

    /// Bounds the sag by the conic's value at the rim plus the sum of the absolute values of all polynomial terms there.
    fn extent_mm(&self, radius_mm: f64) -> Option<[f64; 2]> {
        let rim = self.section.sag_mm(radius_mm * radius_mm)?;
        let rho = radius_mm * self.per_mm;
        let mut power = 1.0;
        let mut most = 0.0;
        for both in &self.orders {
            let all = both.iter().map(|sum| {
                let sizes = sum.iter().rev();
                sizes.fold(0.0, |total, c| total * rho * rho + c.abs())
            });
            most += power * all.sum::<f64>();
            power *= rho;
        }
        Some([rim.min(0.0) - most, rim.max(0.0) + most])
    }

    /// Computed from the terms in x^2 and y^2: (r/R)^2, and (r/R)^2 times the cosine of twice the angle.
    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        let power = |m: usize, i: usize| self.orders.get(m).and_then(|o| o[0].get(i)).copied().unwrap_or(0.0);
        let (round, oval) = (2.0 * power(0, 1), 2.0 * power(2, 0));
        let (c, square) = (self.section.curvature_per_mm, self.per_mm * self.per_mm);
        (c + (round + oval) * square, c + (round - oval) * square)
    }
}

/// A conic plus a sum of Zernike polynomials.
///
/// Use it for figure errors as an interferometer reports them, and for freeform surfaces. The sag is that of a conic of
/// the given radius and conic constant, plus the sum of c_j Z_j(x / R, y / R), with R the normalization radius and
/// `coefficients: [c_1, c_2, ...]` in mm of sag. Angles are measured from +x toward +y. The polynomials continue beyond
/// the normalization radius, where they grow fast: write a `semi-diameter`.
///
/// `ordering: noll` numbers the polynomials as Noll does, each with a mean square of 1 over the disk. `ordering: fringe`
/// numbers them as the University of Arizona does, each 1 at the rim, continued by the same rule.
///
/// # Example
/// ```yaml
/// # Defocus (number 4 of the fringe order) of one wavelength of 550 nm, on a flat window
/// kind: zernike
/// normalization-radius: 12
/// coefficients: [0, 0, 0, 5.5e-4]
/// ordering: fringe
/// thickness: 3
/// glass: SCHOTT/N-BK7
/// semi-diameter: 12
/// ```
/// # References
/// - R. J. Noll, "Zernike polynomials and atmospheric turbulence", J. Opt. Soc. Am. 66, 207 (1976).
/// - J. C. Wyant and K. Creath, "Basic wavefront aberration theory", Applied Optics and Optical Engineering XI (1992).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ZernikeParams {
    /// Radius of curvature of the conic part, mm if bare, not 0: positive if the center lies at larger z; no curvature if
    /// left out.
    #[serde(default = "plane")]
    radius: LengthOrInfinity,
    /// Conic constant of the conic part, any number: 0 is a sphere.
    #[serde(default)]
    conic: f64,
    /// Radius at which the polynomials are normalized, mm if bare, more than 0.
    normalization_radius: Positive<Length>,
    /// Coefficients c_1, c_2, ... from the first polynomial (piston) on, mm of sag; at most 120, missing ones are 0.
    #[schemars(length(max = MOST))]
    coefficients: Vec<f64>,
    /// Numbering and normalization of the polynomials: `noll` (mean square 1) or `fringe` (1 at the rim).
    ordering: ZernikeOrdering,
}

fn plane() -> LengthOrInfinity {
    LengthOrInfinity::Infinite
}

spectra_core::register!(surface "zernike": ZernikeParams, build);

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Surface>, Faults> {
    let p: ZernikeParams = params.parse()?;
    let mut faults = Faults::new();
    shared::curvature(params, "radius", p.radius, &mut faults);
    if !faults.is_empty() {
        return Err(faults);
    }
    let zernike = Zernike::new(p.radius.mm(), p.conic, p.normalization_radius.mm(), &p.coefficients, p.ordering);
    Ok(Box::new(PerRay(FromSag(zernike))))
}
