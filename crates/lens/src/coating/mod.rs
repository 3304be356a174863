//! Coatings: the light that a refracting surface lets through, for bare glass (Fresnel's equations), thin layers or a measured curve.
//!
//! A kind that makes layers or a curve is a file like `v_coat.rs`, which registers itself. Another law is a variant of [`Coating`].
//!
//! The formulas are from Born and Wolf, Principles of Optics, sections 1.5.2 and 1.6.4. Let eta = n cos(theta) for the electric field
//! across the plane of incidence (s) and cos(theta) / n in it (p). A layer of phase thickness delta transmits T = 4 eta eta' / ((eta +
//! eta')^2 cos^2(delta) + (eta eta' / eta_1 + eta_1)^2 sin^2(delta)). T is the same from both sides. Without a layer (delta = 0) it reduces
//! to Fresnel's formula.

mod amplitude;
mod angles;
mod entry;
mod films;
mod films_f32;
mod layers;
mod measured;
mod params;
mod stack;
mod standard;
mod v_coat;

pub use amplitude::{Amplitudes, Polarizing};
pub use angles::{SAME_INDEX, cosine_of_mirrored, cross, dot, versine};
pub use entry::CoatingEntry;
pub use films::{Films, Sides};
pub use films_f32::{CHUNK, FilmsF32, Singles};
pub use measured::MeasuredCoating;
pub(crate) use params::CoatingKeys;
pub use params::{CoatingForm, StatedCoating, read_coating, read_stated_coating};
pub use stack::{Stack, StackLayer};

use spectra_core::math;
use std::sync::Arc;

/// The coating of a refracting surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Coating {
    /// A perfect coating: all light passes.
    #[default]
    Ideal,
    /// No coating: Fresnel's equations.
    Bare,
    /// One dielectric layer.
    Layer {
        /// Refractive index of the layer, the same at all wavelengths.
        index: f64,
        /// Thickness of the layer, nm.
        thickness_nm: f64,
    },
    /// Any number of layers.
    Stack(Arc<Stack>),
    /// A measured curve, the same at every angle.
    Measured(Arc<MeasuredCoating>),
}

/// The transmittance (or reflectance) by polarization: fractions of the power.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transmittance {
    /// Fraction for the electric field perpendicular to the plane of incidence.
    pub s: f64,
    /// Fraction for the electric field in the plane of incidence.
    pub p: f64,
}

/// The reflectance by polarization: fractions of the power that are reflected.
pub type Reflectance = Transmittance;

impl Transmittance {
    /// The transmittance 1, at which all light passes.
    pub const FULL: Self = Self { s: 1.0, p: 1.0 };

    /// Returns the transmittance of unpolarized light: the mean of `s` and `p`.
    #[must_use]
    #[inline(always)]
    pub fn mean(self) -> f64 {
        0.5 * (self.s + self.p)
    }
}

impl Coating {
    /// Returns a layer that is a quarter of a wave thick at a wavelength (nm) at normal incidence.
    #[must_use]
    pub fn quarter_wave(index: f64, wavelength_nm: f64) -> Self {
        Self::Layer { index, thickness_nm: 0.25 * wavelength_nm / index }
    }

    /// Returns the transmittance from a medium of index `n` into a medium of index `n_after`. The cosine of the angle of
    /// incidence is 0 to 1, and the wavelength is in air. The result is 0 on total reflection; otherwise [`Coating::Ideal`]
    /// passes all light.
    #[must_use]
    pub fn transmittance(&self, n: f64, n_after: f64, cos_incidence: f64, wavelength_nm: f64) -> Transmittance {
        let sine = n * (1.0 - cos_incidence * cos_incidence).max(0.0).sqrt();
        let cos_square = 1.0 - sine * sine / (n_after * n_after);
        if cos_square <= 0.0 {
            return Transmittance { s: 0.0, p: 0.0 };
        }
        let cosines = [cos_incidence, cos_square.sqrt()];
        match self {
            Self::Ideal => Transmittance::FULL,
            Self::Bare => bare([n, n_after], cosines),
            Self::Layer { index, thickness_nm } => layer([n, n_after], cosines, *index, thickness_nm / wavelength_nm),
            Self::Stack(stack) => stack.transmittance([n, n_after], cosines, wavelength_nm),
            Self::Measured(measured) => measured.transmittance(wavelength_nm),
        }
    }
}

impl Coating {
    /// Returns the reflectance, with arguments as for [`Coating::transmittance`]. It is 1 on total reflection, otherwise the
    /// fraction that is neither transmitted nor absorbed in the coating. A measured coating reflects all light that it does not
    /// transmit.
    #[must_use]
    pub fn reflectance(&self, n: f64, n_after: f64, cos_incidence: f64, wavelength_nm: f64) -> Reflectance {
        let cos_square = cos_square_beyond(n, n_after, cos_incidence);
        if cos_square <= 0.0 {
            return Reflectance::FULL;
        }
        let (c, c_after) = (cos_incidence, cos_square.sqrt());
        match self {
            Self::Bare => bare_reflectance(n, n_after, c),
            Self::Stack(stack) => stack.reflectance([n, n_after], [c, c_after], wavelength_nm),
            lossless => {
                let passes = lossless.transmittance(n, n_after, c, wavelength_nm);
                Reflectance { s: 1.0 - passes.s, p: 1.0 - passes.p }
            }
        }
    }
}

/// Square of the cosine of the angle of refraction; negative on total reflection.
#[inline(always)]
fn cos_square_beyond(n: f64, n_after: f64, cos_incidence: f64) -> f64 {
    let sine_square = 1.0 - cos_incidence * cos_incidence;
    let sine = n * (if sine_square > 0.0 { sine_square } else { 0.0 }).sqrt();
    1.0 - sine * sine / (n_after * n_after)
}

/// Returns the reflectance of bare glass, like [`Coating::reflectance`] of [`Coating::Bare`].
#[inline(always)]
pub fn bare_reflectance(n: f64, n_after: f64, cos_incidence: f64) -> Reflectance {
    let cos_square = cos_square_beyond(n, n_after, cos_incidence);
    let is_total = cos_square <= 0.0;
    // On total reflection this root is not a number.
    let (c, c_after) = (cos_incidence, cos_square.sqrt());
    let s = (n * c - n_after * c_after) / (n * c + n_after * c_after);
    let p = (n_after * c - n * c_after) / (n_after * c + n * c_after);
    Reflectance { s: if is_total { 1.0 } else { s * s }, p: if is_total { 1.0 } else { p * p } }
}

/// Transmittance by Fresnel's equations from the indices and cosines on both sides.
fn bare([n, n_after]: [f64; 2], [c, c_after]: [f64; 2]) -> Transmittance {
    let pass = |a: f64, b: f64| 4.0 * a * b / ((a + b) * (a + b));
    Transmittance { s: pass(n * c, n_after * c_after), p: pass(n_after * c, n * c_after) }
}

/// Square of `n_1 cos(theta_1)` in a layer; negative if light does not propagate in the layer but decays.
fn layer_square(index: f64, n: f64, c: f64) -> f64 {
    index * index - n * n * (1.0 - c * c)
}

/// Transmittance of a layer in which light propagates: `in_layer` is n_1 cos(theta_1), `waves` the thickness divided by the wavelength.
fn running_layer(
    [n, n_after]: [f64; 2],
    [c, c_after]: [f64; 2],
    index: f64,
    in_layer: f64,
    waves: f64,
) -> Transmittance {
    let turns = in_layer * waves;
    let (sin, cos) = math::sin_cos_turns(turns - turns.floor());
    let (sin2, cos2) = (sin * sin, cos * cos);
    let pass = |a: f64, b: f64, layer: f64| {
        let (sum, through) = (a + b, a * b / layer + layer);
        4.0 * a * b / (sum * sum * cos2 + through * through * sin2)
    };
    Transmittance {
        s: pass(n * c, n_after * c_after, in_layer),
        p: pass(c / n, c_after / n_after, in_layer / (index * index)),
    }
}

/// Transmittance of any layer. In a thin layer of low index between two glasses light may decay, and some of it tunnels through.
fn layer([n, n_after]: [f64; 2], [c, c_after]: [f64; 2], index: f64, waves: f64) -> Transmittance {
    let square = layer_square(index, n, c);
    if square > 0.0 {
        return running_layer([n, n_after], [c, c_after], index, square.sqrt(), waves);
    }
    // eta_1 and delta become imaginary: cos turns into cosh, sin into i sinh.
    let decay = (-square).sqrt();
    let depth = std::f64::consts::TAU * decay * waves;
    if depth > 300.0 {
        return Transmittance { s: 0.0, p: 0.0 };
    }
    let (up, down) = (math::exp(depth), math::exp(-depth));
    let (sinh, cosh) = (0.5 * (up - down), 0.5 * (up + down));
    // sinh divided by eta_1; at the critical angle both vanish, and the ratio is that of their slopes.
    let pass = |a: f64, b: f64, scale: f64| {
        let layer = decay / scale;
        let ratio = if decay > 0.0 { sinh / layer } else { std::f64::consts::TAU * waves * scale };
        let (sum, through) = ((a + b) * cosh, a * b * ratio - layer * sinh);
        4.0 * a * b / (sum * sum + through * through)
    };
    Transmittance { s: pass(n * c, n_after * c_after, 1.0), p: pass(c / n, c_after / n_after, index * index) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reflectance(coating: &Coating, n: f64, angle_deg: f64, wavelength_nm: f64) -> (f64, f64) {
        let t = coating.transmittance(1.0, n, math::cos(angle_deg.to_radians()), wavelength_nm);
        (1.0 - t.s, 1.0 - t.p)
    }

    /// Reflectances match textbook values at n = 1.5, to six decimals.
    #[test]
    fn bare_glass_by_angle() {
        for (angle, s, p) in [
            (0.0, 0.04, 0.04),
            (30.0, 0.057796, 0.025249),
            (45.0, 0.092013, 0.008466),
            (60.0, 0.176571, 0.001802),
            (80.0, 0.538595, 0.236814),
        ] {
            let got = reflectance(&Coating::Bare, 1.5, angle, 550.0);
            assert!((got.0 - s).abs() < 1e-6 && (got.1 - p).abs() < 1e-6, "{angle}: {got:?}");
        }
        assert!(reflectance(&Coating::Bare, 1.5, math::atan(1.5).to_degrees(), 550.0).1.abs() < 1e-15);
    }

    /// At normal incidence: (n - 1)^2 / (n + 1)^2, (n1^2 - n)^2 / (n1^2 + n)^2 for a quarter wave, and Airy's sum for 99.6 nm.
    #[test]
    fn one_layer_at_normal_incidence() {
        let quarter = Coating::quarter_wave(1.38, 587.56);
        let thin = Coating::Layer { index: 1.38, thickness_nm: 99.6 };
        for (coating, n, wavelength_nm, want) in [
            (Coating::Bare, 1.5168, 587.56, 0.042_164_6),
            (quarter.clone(), 1.5168, 587.56, 0.012_835_4),
            (Coating::Bare, 1.518522, 550.0, 0.042_388),
            (thin, 1.518522, 550.0, 0.012_708_8),
        ] {
            let (s, p) = reflectance(&coating, n, 0.0, wavelength_nm);
            assert!((s - want).abs() < 5e-7 && (p - want).abs() < 5e-7, "{coating:?}: {s} {p} {want}");
        }
    }

    /// Computes R and T from the amplitudes of three media in complex numbers (Born and Wolf 1.6.4, eq. 55 to 58), written out separately.
    fn airy(n: [f64; 3], cos0: f64, waves: f64, p: bool) -> (f64, f64) {
        let cosine = |k: usize| (1.0 - (n[0] / n[k]).powi(2) * (1.0 - cos0 * cos0)).sqrt();
        let c = [cos0, cosine(1), cosine(2)];
        let r = |a: usize, b: usize| {
            let (x, y) = if p { (n[b] * c[a], n[a] * c[b]) } else { (n[a] * c[a], n[b] * c[b]) };
            (x - y) / (x + y)
        };
        let t = |a: usize, b: usize| {
            let down = if p { n[b] * c[a] + n[a] * c[b] } else { n[a] * c[a] + n[b] * c[b] };
            2.0 * n[a] * c[a] / down
        };
        let beta = std::f64::consts::TAU * n[1] * c[1] * waves;
        let (r01, r12) = (r(0, 1), r(1, 2));
        let (co, si) = (math::cos(2.0 * beta), math::sin(2.0 * beta));
        let up = (r01 + r12 * co).powi(2) + (r12 * si).powi(2);
        let down = (1.0 + r01 * r12 * co).powi(2) + (r01 * r12 * si).powi(2);
        let through = (t(0, 1) * t(1, 2)).powi(2) / down * n[2] * c[2] / (n[0] * c[0]);
        (up / down, through)
    }

    /// R and T of the sum over all bounces add up to one, and T matches the code under test, at every angle, thickness and polarization.
    #[test]
    fn a_layer_keeps_energy() {
        for n in [[1.0, 1.38, 1.5168], [1.0, 2.1, 1.9], [1.7, 1.38, 1.0], [1.6, 1.5, 1.7]] {
            for step in 0..40 {
                let cos0 = 1.0 - 0.19 * f64::from(step) / 40.0;
                for waves in [0.05, 0.18, 0.25, 1.3] {
                    let coating = Coating::Layer { index: n[1], thickness_nm: waves * 500.0 };
                    let got = coating.transmittance(n[0], n[2], cos0, 500.0);
                    for (p, got) in [(false, got.s), (true, got.p)] {
                        let (r, t) = airy(n, cos0, waves, p);
                        if t.is_nan() {
                            assert_eq!(got, 0.0);
                            continue;
                        }
                        assert!(
                            (r + t - 1.0).abs() < 1e-12 && (got - t).abs() < 1e-12,
                            "{n:?} {cos0} {waves} {p}: {got} {t}"
                        );
                    }
                }
            }
        }
    }

    /// An equal fraction of light passes backward along the same path.
    #[test]
    fn both_ways_alike() {
        for coating in
            [Coating::Bare, Coating::quarter_wave(1.38, 550.0), Coating::Layer { index: 1.1, thickness_nm: 90.0 }]
        {
            for (n, m) in [(1.0, 1.8), (1.7, 1.5)] {
                for step in 0..20 {
                    let cos = 1.0 - 0.04 * f64::from(step);
                    let there = coating.transmittance(n, m, cos, 480.0);
                    let cos_after = (1.0 - (n / m) * (n / m) * (1.0 - cos * cos)).max(0.0).sqrt();
                    if cos_after < 1e-3 {
                        continue;
                    }
                    let back = coating.transmittance(m, n, cos_after, 480.0);
                    assert!(
                        (there.s - back.s).abs() < 1e-11 && (there.p - back.p).abs() < 1e-11,
                        "{coating:?} {n} {cos}"
                    );
                }
            }
        }
    }

    /// Beyond the critical angle a wide gap of air between two prisms passes nothing, and no gap passes everything. For equal
    /// glasses T = 1 / (1 + (a sinh(depth))^2) (frustrated total reflection, s light: a = (q^2 + e^2) / (2 q e)).
    #[test]
    fn light_tunnels_through_a_thin_gap() {
        let (n, cos) = (1.5_f64, 0.6_f64);
        let gap = |nm: f64| Coating::Layer { index: 1.0, thickness_nm: nm }.transmittance(n, n, cos, 500.0);
        assert!((gap(1e-6).s - 1.0).abs() < 1e-9 && gap(50_000.0).s == 0.0 && gap(5000.0).p < 1e-9);
        let decay = (n * n * (1.0 - cos * cos) - 1.0).sqrt();
        let e = n * cos;
        for nm in [20.0, 100.0, 300.0] {
            let depth: f64 = std::f64::consts::TAU * decay * nm / 500.0;
            let a = (decay * decay + e * e) / (2.0 * decay * e) * depth.sinh();
            assert!((gap(nm).s - 1.0 / (1.0 + a * a)).abs() < 1e-12, "{nm}");
        }
        // At the critical angle both forms meet.
        let critical = (1.0 - 1.0 / (n * n)).sqrt();
        let at = |cos: f64| Coating::Layer { index: 1.0, thickness_nm: 120.0 }.transmittance(n, n, cos, 500.0);
        for delta in [-1e-9, 0.0, 1e-9] {
            let (here, there) = (at(critical + delta), at(critical + 1e-7));
            assert!((here.s - there.s).abs() < 1e-5 && (here.p - there.p).abs() < 1e-5, "{delta}");
        }
    }
}
