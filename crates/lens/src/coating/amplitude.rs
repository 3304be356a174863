//! The effect of a surface on polarized light: complex amplitudes of the two linear states.
//!
//! Follows Born and Wolf, Principles of Optics, sections 1.5 and 1.6, with the time factor exp(i omega t). The s field lies across the
//! plane of incidence, along d x d' (the directions before and after). The p field lies along d x s before and d' x s after.

use super::stack::{Complex, Stack, StackLayer};
use super::{Coating, Transmittance};
use std::borrow::Cow;

/// The effect of a surface on the power and polarization of light. It consists of the fractions of s and p light, and the product
/// of the s amplitude and the conjugate p amplitude. The quantity U + i V of the light is multiplied by that product.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polarizing {
    /// Fraction of the power of s light.
    pub s: f64,
    /// Fraction of the power of p light.
    pub p: f64,
    /// Amplitude of s times the conjugate amplitude of p: real and imaginary parts.
    pub mixed: [f64; 2],
}

impl Polarizing {
    /// Returns an effect that leaves the fraction `part` of the light, whatever its polarization. `mirrored` says that the light
    /// is reflected.
    pub fn evenly(part: f64, mirrored: bool) -> Self {
        // A perfect conductor shifts the phase of s light by half a wave, but not that of p light, because its axis turns.
        Self { s: part, p: part, mixed: [if mirrored { -part } else { part }, 0.0] }
    }

    /// Mixes two effects: the fraction `part` of the light undergoes `other`, the rest this effect.
    pub fn beside(self, part: f64, other: Self) -> Self {
        let between = |a: f64, b: f64| a + part * (b - a);
        Self {
            s: between(self.s, other.s),
            p: between(self.p, other.p),
            mixed: [between(self.mixed[0], other.mixed[0]), between(self.mixed[1], other.mixed[1])],
        }
    }

    /// Creates an effect from fractions of power, without a phase difference.
    fn of_parts(parts: Transmittance, mirrored: bool) -> Self {
        let both = (parts.s * parts.p).sqrt();
        Self { s: parts.s, p: parts.p, mixed: [if mirrored { -both } else { both }, 0.0] }
    }

    fn of_amplitudes([s, p]: [Complex; 2]) -> Self {
        let mixed = s * p.conjugate();
        Self { s: s.size2(), p: p.size2(), mixed: [mixed.re, mixed.im] }
    }
}

/// A coating, prepared for the computation of amplitudes.
pub enum Amplitudes<'a> {
    /// A stack of layers; without layers it is bare glass.
    Stack(Cow<'a, Stack>),
    /// A coating that yields only powers, without phases.
    Powers(&'a Coating),
}

impl<'a> Amplitudes<'a> {
    /// Prepares a coating for the computation of amplitudes.
    #[must_use]
    pub fn of(coating: &'a Coating) -> Self {
        match coating {
            Coating::Bare => Self::Stack(Cow::Owned(Stack::new(Vec::new()))),
            Coating::Layer { index, thickness_nm } => {
                Self::Stack(Cow::Owned(Stack::new(vec![StackLayer::constant(*thickness_nm, *index, 0.0)])))
            }
            Coating::Stack(stack) => Self::Stack(Cow::Borrowed(stack)),
            Coating::Ideal | Coating::Measured(_) => Self::Powers(coating),
        }
    }

    /// Computes the effect on light that passes from a medium of index `n` into a medium of index `n_after`. `cosine` is the
    /// cosine of the angle of incidence.
    pub fn through(&self, n: f64, n_after: f64, cosine: f64, wavelength_nm: f64) -> Polarizing {
        match self {
            Self::Stack(stack) => {
                let passes = stack.amplitudes([n, n_after], cosine, wavelength_nm).map(|[through, _]| through);
                Polarizing::of_amplitudes(passes)
            }
            Self::Powers(coating) => {
                Polarizing::of_parts(coating.transmittance(n, n_after, cosine, wavelength_nm), false)
            }
        }
    }

    /// Computes the effect on light that is reflected in a medium of index `n` by a surface to a medium of index `n_after`.
    /// `cosine` is the cosine of the angle of incidence. Total reflection shifts the phases of s and p light against each other.
    pub fn back(&self, n: f64, n_after: f64, cosine: f64, wavelength_nm: f64) -> Polarizing {
        match self {
            Self::Stack(stack) => {
                let [s, p] = stack.amplitudes([n, n_after], cosine, wavelength_nm).map(|[_, back]| back);
                // These amplitudes are of the tangential fields; the axis of p light turns round.
                Polarizing::of_amplitudes([s, p.negated()])
            }
            Self::Powers(coating) => Polarizing::of_parts(coating.reflectance(n, n_after, cosine, wavelength_nm), true),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::math;

    /// Fresnel's rhomb (Born and Wolf, 1.5.4): at n = 1.51 total reflection shifts s and p against each other by 45 degrees at 48 degrees
    /// 37 minutes and at 54 degrees 37 minutes. At other angles the shift is tan(delta / 2) = cos(t) sqrt(sin(t)^2 - 1 / n^2) / sin(t)^2.
    #[test]
    fn total_reflection_turns_the_phase() {
        let bare = Amplitudes::of(&Coating::Bare);
        let turn = |degrees: f64| {
            let got = bare.back(1.51, 1.0, math::cos(degrees.to_radians()), 550.0);
            assert!((got.s - 1.0).abs() < 1e-12 && (got.p - 1.0).abs() < 1e-12);
            math::atan2(got.mixed[1], got.mixed[0]).abs().to_degrees()
        };
        for degrees in [48.0 + 37.0 / 60.0, 54.0 + 37.0 / 60.0] {
            assert!((turn(degrees) - 45.0).abs() < 0.05, "{degrees}: {}", turn(degrees));
        }
        for degrees in [42.0_f64, 50.0, 60.0, 85.0] {
            let (sin, cos) = (math::sin(degrees.to_radians()), math::cos(degrees.to_radians()));
            let want = 2.0 * math::atan(cos * (sin * sin - 1.0 / (1.51 * 1.51)).sqrt() / (sin * sin));
            assert!((turn(degrees) - want.to_degrees()).abs() < 1e-9, "{degrees}");
        }
    }

    /// Powers match those of the coating. A layer's amplitudes match the sum over all bounces (Born and Wolf 1.6.4, eq. 55 and
    /// 56), in fields along and across the plane of incidence.
    #[test]
    fn a_layer_is_the_sum_of_its_bounces() {
        let complex = |re, im| Complex { re, im };
        for ([n0, n1, n2], nm) in [([1.0, 1.38, 1.52], 99.6), ([1.7, 1.38, 1.0], 140.0), ([1.0, 2.1, 1.6], 60.0)] {
            for cosine in [1.0_f64, 0.95, 0.85] {
                let coating = Coating::Layer { index: n1, thickness_nm: nm };
                let amplitudes = Amplitudes::of(&coating);
                let (through, back) =
                    (amplitudes.through(n0, n2, cosine, 550.0), amplitudes.back(n0, n2, cosine, 550.0));
                let (t, r) = (coating.transmittance(n0, n2, cosine, 550.0), coating.reflectance(n0, n2, cosine, 550.0));
                for (a, b) in [(through.s, t.s), (through.p, t.p), (back.s, r.s), (back.p, r.p)] {
                    assert!((a - b).abs() < 1e-12, "{a} {b}");
                }
                let cos = |n: f64| (1.0 - n0 * n0 * (1.0 - cosine * cosine) / (n * n)).sqrt();
                let c = [cosine, cos(n1), cos(n2)];
                let turn = 4.0 * std::f64::consts::PI * n1 * c[1] * nm / 550.0;
                let bounce = complex(math::cos(turn), -math::sin(turn));
                // Fields as in Fresnel's equations; r of p light refers to its magnetic field.
                let bounces = |r01: f64, r12: f64| {
                    (complex(r01, 0.0) + complex(r12, 0.0) * bounce)
                        / (complex(1.0, 0.0) + complex(r01 * r12, 0.0) * bounce)
                };
                let s = |a: f64, ca: f64, b: f64, cb: f64| (a * ca - b * cb) / (a * ca + b * cb);
                let p = |a: f64, ca: f64, b: f64, cb: f64| (b * ca - a * cb) / (b * ca + a * cb);
                let want = bounces(s(n0, c[0], n1, c[1]), s(n1, c[1], n2, c[2]))
                    * bounces(p(n0, c[0], n1, c[1]), p(n1, c[1], n2, c[2])).conjugate();
                assert!((back.mixed[0] - want.re).abs() < 1e-12 && (back.mixed[1] - want.im).abs() < 1e-12);
                let deny = |r01: f64, r12: f64| complex(1.0, 0.0) + complex(r01 * r12, 0.0) * bounce;
                let (ds, dp) = (
                    deny(s(n0, c[0], n1, c[1]), s(n1, c[1], n2, c[2])),
                    deny(p(n0, c[0], n1, c[1]), p(n1, c[1], n2, c[2])),
                );
                // t is a real number divided by these denominators, times the same phase for both.
                let size = (through.s * through.p).sqrt() * (ds.size2() * dp.size2()).sqrt();
                let want = complex(size, 0.0) / (ds * dp.conjugate());
                assert!((through.mixed[0] - want.re).abs() < 1e-12 && (through.mixed[1] - want.im).abs() < 1e-12);
            }
        }
    }
}
