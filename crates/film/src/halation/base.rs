//! Light that returns from the back of a film, over the distance.

use spectra_core::math::pow;
use std::f64::consts::PI;

/// The base of a film and its backing, as they affect halation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalationBase {
    /// Thickness of the base, mm: 0.125 for acetate roll and 35 mm film.
    pub thickness_mm: f64,
    /// Refractive index of the base, above 1, up to 4: 1.48 for acetate, 1.64 for polyester (in its plane).
    pub index: f64,
    /// Light that the emulsion lets through into the base, relative to the light that exposes the layer, 0 to 10.
    pub entering: f64,
    /// Transmittance of base and backing together, for one pass along the normal, 0 to 1. Light passes them twice. At the angle theta each
    /// pass has the transmittance to the power 1/cos(theta).
    pub transmittance: f64,
    /// Share of the light arriving at the emulsion from the base that the emulsion reflects back down, 0 to 0.95. This share
    /// starts a further trip through the base.
    pub reflected: f64,
}

/// An error for values with which halation cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HalationError {
    /// A value is out of range.
    #[error("{what} {value} is out of range: {range}")]
    OutOfRange {
        /// Name of the value.
        what: &'static str,
        /// Value that was given.
        value: f64,
        /// Range of the value.
        range: &'static str,
    },
}

impl HalationBase {
    /// Checks that all values are in range.
    ///
    /// # Errors
    /// The first value that is out of range.
    pub(super) fn check(&self) -> Result<(), HalationError> {
        let checks = [
            ("thickness", self.thickness_mm, (1e-3..=10.0).contains(&self.thickness_mm), "0.001 to 10 mm"),
            ("index", self.index, self.index > 1.0 && self.index <= 4.0, "above 1, up to 4"),
            ("light entering the base", self.entering, (0.0..=10.0).contains(&self.entering), "0 to 10"),
            ("transmittance", self.transmittance, (0.0..=1.0).contains(&self.transmittance), "0 to 1"),
            ("light reflected down again", self.reflected, (0.0..=0.95).contains(&self.reflected), "0 to 0.95"),
        ];
        match checks.into_iter().find(|(_, _, good, _)| !good) {
            Some((what, value, _, range)) => Err(HalationError::OutOfRange { what, value, range }),
            None => Ok(()),
        }
    }

    /// Radius at which the ring of total reflection begins: 2 t tan(asin(1/n)), mm.
    #[must_use]
    pub fn ring_radius_mm(&self) -> f64 {
        2.0 * self.thickness_mm / (self.index * self.index - 1.0).sqrt()
    }

    /// Returns the light that comes back after one trip at the distance `r_mm` from an exposed point, relative to the light that
    /// exposes the point, per mm^2. For all trips see [`super::ReturnedLight`].
    #[must_use]
    pub fn density_per_mm2(&self, r_mm: f64) -> f64 {
        let t2 = 4.0 * self.thickness_mm * self.thickness_mm;
        let s2 = r_mm * r_mm + t2;
        self.entering * self.back(r_mm * r_mm / s2) * t2 / (PI * s2 * s2)
    }

    /// Fraction of a ray with sin^2(theta) = `u` that returns.
    fn back(&self, u: f64) -> f64 {
        let cosine = (1.0 - u).max(0.0).sqrt();
        // The path at grazing incidence is endless: nothing is left unless nothing is absorbed.
        let through = if self.transmittance == 1.0 {
            1.0
        } else if cosine < 1e-6 {
            0.0
        } else {
            pow(self.transmittance, 2.0 / cosine)
        };
        through * internal_reflectance(self.index, u)
    }

    /// Returns the halation of one trip: the light that comes back from the base, relative to the light that exposes the layer.
    /// It is the integral of [`HalationBase::density_per_mm2`] over the plane.
    #[must_use]
    pub fn returned(&self) -> f64 {
        self.returned_weighted(|_| 1.0)
    }

    /// Returns the part of [`HalationBase::returned`] that comes back within the distance `r_mm` of the exposed point.
    #[must_use]
    pub fn returned_within(&self, r_mm: f64) -> f64 {
        let r2 = r_mm * r_mm;
        self.integral(r2 / (r2 + 4.0 * self.thickness_mm * self.thickness_mm), |_| 1.0)
    }

    /// Integral of `weight(r_mm)` times the light that returns at r, for a smooth weight.
    pub(super) fn returned_weighted(&self, weight: impl Fn(f64) -> f64) -> f64 {
        self.integral(1.0, weight)
    }

    /// Integral up to sin^2(theta) = `end`. Light of constant radiance is uniform in u = sin^2(theta).
    fn integral(&self, end: f64, weight: impl Fn(f64) -> f64) -> f64 {
        let radius = |u: f64| 2.0 * self.thickness_mm * (u / (1.0 - u)).sqrt();
        let value = |u: f64| self.back(u) * weight(radius(u));
        let critical = 1.0 / (self.index * self.index);
        // The reflectance reaches 1 as a square root: the substitution u = critical - v^2 makes it smooth.
        // Above the critical angle, u = 1 - w^2 does the same for the cosine.
        let low = critical.min(end);
        let below = midpoint((critical - low).sqrt(), critical.sqrt(), |v| 2.0 * v * value(critical - v * v));
        let beyond = if end > critical {
            midpoint((1.0 - end).sqrt(), (1.0 - critical).sqrt(), |w| 2.0 * w * value(1.0 - w * w))
        } else {
            0.0
        };
        self.entering * (below + beyond)
    }
}

/// Midpoint rule, accurate to about 1e-8 for smooth integrands.
fn midpoint(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    const STEPS: usize = 20_000;
    let step = (to - from) / STEPS as f64;
    (0..STEPS).map(|i| f(from + (i as f64 + 0.5) * step)).sum::<f64>() * step
}

/// Reflectance of unpolarized light at the surface between `index` and air, where sin^2 of the angle inside is `u` (A. Fresnel; M. Born and
/// E. Wolf, "Principles of Optics", 1.5.2).
pub(super) fn internal_reflectance(index: f64, u: f64) -> f64 {
    let outside = 1.0 - index * index * u;
    if outside <= 0.0 {
        return 1.0;
    }
    let (inside, outside) = ((1.0 - u).sqrt(), outside.sqrt());
    let s = (index * inside - outside) / (index * inside + outside);
    let p = (inside - index * outside) / (inside + index * outside);
    (s * s + p * p) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::math::{asin, sin, tan};

    const ACETATE: HalationBase =
        HalationBase { thickness_mm: 0.125, index: 1.48, entering: 1.0, transmittance: 1.0, reflected: 0.0 };

    #[test]
    fn ring_begins_at_total_reflection() {
        let want = 2.0 * 0.125 * tan(asin(1.0 / 1.48));
        assert!((ACETATE.ring_radius_mm() - want).abs() < 1e-15);
        assert!((want - 0.2291).abs() < 5e-5);
    }

    /// Compares with Snell's and Fresnel's laws in angles: n = 1.5 to air. At 45 degrees outside, Rs = .092013 and Rp = .008466 (Born and
    /// Wolf), equal to those from inside at the angle of refraction.
    #[test]
    fn reflectance_is_fresnels() {
        let u = |outside_deg: f64| {
            let s = sin(outside_deg.to_radians()) / 1.5;
            s * s
        };
        for (angle, s, p) in
            [(0.0, 0.04, 0.04), (30.0, 0.057796, 0.025249), (45.0, 0.092013, 0.008466), (80.0, 0.538595, 0.236814)]
        {
            let got = internal_reflectance(1.5, u(angle));
            assert!((got - (s + p) / 2.0).abs() < 1e-6, "{angle}: {got}");
        }
        assert_eq!(internal_reflectance(1.5, 0.45), 1.0);
    }

    /// Diffuse light inside n = 1.5 that is reflected at its surface: 0.59605. This follows from the closed form of S. Q. Duntley (J.
    /// Optical Society of America 32, 1942, 61) for light from outside, .09178, and 1 - (1 - .09178) / n^2.
    #[test]
    fn returned_light_is_the_internal_diffuse_reflectance() {
        let n: f64 = 1.5;
        let n2 = n * n;
        let ln = |x: f64| spectra_core::math::log(x);
        let outside = 0.5
            + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0) * (n + 1.0))
            + n2 * (n2 - 1.0) * (n2 - 1.0) / ((n2 + 1.0) * (n2 + 1.0) * (n2 + 1.0)) * ln((n - 1.0) / (n + 1.0))
            - 2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n2 * n2 - 1.0))
            + 8.0 * n2 * n2 * (n2 * n2 + 1.0) / ((n2 + 1.0) * (n2 * n2 - 1.0) * (n2 * n2 - 1.0)) * ln(n);
        assert!((outside - 0.09178).abs() < 1e-4, "{outside}");
        let want = 1.0 - (1.0 - outside) / n2;
        let got = HalationBase { index: n, ..ACETATE }.returned();
        assert!((got - want).abs() < 1e-7, "{got} {want}");
    }

    /// The radial density, summed ring by ring, equals the integral over angles.
    #[test]
    fn density_sums_to_what_returns() {
        let base = HalationBase { transmittance: 0.8, entering: 0.3, ..ACETATE };
        for end in [0.1, 0.2, 0.2291, 0.4, 3.0] {
            let step = end / 400_000.0;
            let sum: f64 = (0..400_000)
                .map(|i| (f64::from(i) + 0.5) * step)
                .map(|r| base.density_per_mm2(r) * 2.0 * PI * r * step)
                .sum();
            assert!((sum - base.returned_within(end)).abs() < 1e-6 * 0.3, "{end}: {sum} {}", base.returned_within(end));
        }
    }

    #[test]
    fn bad_values_are_named() {
        for (base, what) in [
            (HalationBase { thickness_mm: 0.0, ..ACETATE }, "thickness"),
            (HalationBase { index: 1.0, ..ACETATE }, "index"),
            (HalationBase { entering: -0.1, ..ACETATE }, "entering"),
            (HalationBase { transmittance: f64::NAN, ..ACETATE }, "transmittance"),
            (HalationBase { reflected: 1.0, ..ACETATE }, "again"),
        ] {
            assert!(base.check().unwrap_err().to_string().contains(what));
        }
        assert_eq!(ACETATE.check(), Ok(()));
    }
}
