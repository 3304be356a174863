//! Clear layers and bare glass for whole batches: the closed forms of this folder, written so that each ray takes few square roots and
//! divisions.
//!
//! Let n and n' be the indices on both sides, q the cosine of the angle between the directions, h = 1 - q and d = n' - n. The normal is
//! parallel to n' d' - n d, whose length is G with G^2 = d^2 + 2 n n' h. Hence cos(theta) = |u| / G and cos(theta') = |v| / G, with
//! u = d - n' h and v = d + n h, which have the same sign. Fresnel's equations are of degree zero in the cosines, so G cancels.
//!
//! A layer's matrix holds cos(delta), sin(delta) / eta and eta sin(delta). All are even in delta, so they are entire functions of
//! delta^2 = (2 pi d / lambda)^2 (N^2 - n^2 sin^2(theta)): power series without roots or cases, which also hold where
//! light decays in the layer. The series are evaluated at delta / 2^H, and the angle is doubled H times.

use std::f64::consts::TAU;
use std::ops::{Add, Mul, Sub};

/// Largest square of delta / 2^H for which the series hold: the first omitted terms are 6e-15 (cosine) and 7e-14 (sine).
const SERIES_REACH: f64 = 1.5;

/// Largest number of halvings: each doubling makes an error four times as large, 1e-13 in all.
const MOST_HALVINGS: u32 = 5;

/// A stack of `N` clear layers, each with the same index at all wavelengths. The first one is next to the medium of the lower index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Films<const N: usize> {
    /// Square of the index of each layer.
    pub(super) square: [f64; N],
    /// One over the square of the index of each layer.
    pub(super) per_square: [f64; N],
    /// The thickness of each layer times 2 pi, nm.
    pub(super) turn_nm: [f64; N],
}

/// Quantities that a batch kernel needs about the two sides of a surface, as defined at the head of this file.
#[derive(Clone, Copy, Debug)]
pub struct Sides {
    n: f64,
    n_after: f64,
    h: f64,
    u: f64,
    v: f64,
}

impl Sides {
    /// Creates the quantities from the indices on both sides and `h`, the versine (1 - cos) of the angle by which light is bent.
    #[inline(always)]
    pub fn of(n: f64, n_after: f64, h: f64) -> Self {
        let step = n_after - n;
        Self { n, n_after, h, u: step - n_after * h, v: step + n * h }
    }

    /// Absolute difference of the refractive indices on the two sides of the surface.
    #[inline(always)]
    pub fn step(&self) -> f64 {
        (self.n_after - self.n).abs()
    }

    /// Cosine of the angle of incidence, at most 1.
    pub fn cosine(&self) -> f64 {
        let step = self.n_after - self.n;
        (self.u * self.u / (step * step + 2.0 * self.n * self.n_after * self.h)).sqrt().min(1.0)
    }

    /// Fraction of unpolarized light that bare glass transmits, by a shorter form of Fresnel's equations.
    #[inline(always)]
    pub fn bare(&self) -> f64 {
        let Self { n, n_after, u, v, .. } = *self;
        let (s, p) = (n * u + n_after * v, n_after * u + n * v);
        let (s, p) = (s * s, p * p);
        2.0 * (n * n_after) * (u * v) * (s + p) / (s * p)
    }
}

impl<const N: usize> Films<N> {
    /// Creates a stack from the index and the thickness (nm) of each layer.
    pub fn new(layers: &[[f64; 2]; N]) -> Self {
        let square = layers.map(|[index, _]| index * index);
        Self { square, per_square: square.map(|s| 1.0 / s), turn_nm: layers.map(|[_, nm]| TAU * nm) }
    }

    /// Returns how often the angle must be halved for the series to hold, for wavelengths of `shortest_nm` or longer. `low` is
    /// the lower index of the two media. Returns `None` if that takes more than 5 halvings, or if a value is NaN.
    pub fn halvings(&self, shortest_nm: f64, low: f64) -> Option<u32> {
        let largest = self.square.iter().zip(&self.turn_nm).map(|(square, turn_nm)| {
            let turn = turn_nm / shortest_nm;
            turn * turn * f64::max(low * low - square, *square)
        });
        let good = |h: &u32| largest.clone().all(|z| z <= SERIES_REACH * f64::from(1_u32 << (2 * h)));
        (0..=MOST_HALVINGS).find(good)
    }

    /// Returns the fraction of unpolarized light that the layers transmit. `per_nm` is one over the wavelength, 1/nm, and `H` the
    /// number of halvings. The result is the mean of T = 4 eta eta' / ((eta a + eta' d)^2 + (eta eta' x + y)^2) for both
    /// polarizations. [a, i x; i y, d] is the product of the layers' matrices from the lower index on. For light in the plane of
    /// incidence, numerator and denominator are both multiplied by the cosines.
    #[inline(always)]
    pub fn passes<const H: usize>(&self, sides: &Sides, per_nm: f64) -> f64 {
        let Sides { n, n_after, h, u, v } = *sides;
        let (both, step) = (n * n_after, n_after - n);
        let per_g2 = 1.0 / (step * step + 2.0 * both * h);
        let cosines = u * v * per_g2;
        let tangential = both * both * h * (2.0 - h) * per_g2;
        let up = step > 0.0;
        let (low, u_low) = if up { (n, u) } else { (n_after, v) };
        let (high, u_high) = if up { (n_after, v) } else { (n, u) };
        let (mut s, mut p) = ([1.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0]);
        for k in 0..N {
            let along2 = self.square[k] - tangential;
            let turn = self.turn_nm[k] * per_nm;
            let (cos, sinc) = cos_and_sinc::<H>(turn * turn * along2);
            // sin(delta) / (N cos(theta)).
            let over = sinc * turn;
            let next_s = [cos, over, along2 * over, cos];
            let next_p = [cos, along2 * over * self.per_square[k], self.square[k] * over, cos];
            (s, p) = if k == 0 { (next_s, next_p) } else { (times(s, next_s), times(p, next_p)) };
        }
        let [a, x, y, d] = s;
        let (re, im) = (low * u_low * a + high * u_high * d, both * cosines * x + y);
        let s = re * re * per_g2 + im * im;
        let [a, x, y, d] = p;
        let (re, im) = (low * u_high * a + high * u_low * d, both * x + cosines * y);
        let p = re * re * per_g2 + im * im;
        2.0 * both * cosines * (s + p) / (s * p)
    }
}

/// Multiplies two matrices [a, i x; i y, d] with real a, x, y and d.
#[inline(always)]
pub(super) fn times<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T>>(
    [a, x, y, d]: [T; 4],
    [a2, x2, y2, d2]: [T; 4],
) -> [T; 4] {
    [a * a2 - x * y2, a * x2 + x * d2, y * a2 + d * y2, d * d2 - y * x2]
}

/// Computes cos(delta) and sin(delta) / delta from the square of delta, which may be negative; valid up to 1.5 * 4^H.
#[inline(always)]
fn cos_and_sinc<const H: usize>(square: f64) -> (f64, f64) {
    let z = square * const { 1.0 / (1_u64 << (2 * H)) as f64 };
    let cos_end = 1.0 / 40_320.0
        + z * (-1.0 / 3_628_800.0
            + z * (1.0 / 479_001_600.0 + z * (-1.0 / 87_178_291_200.0 + z * (1.0 / 20_922_789_888_000.0))));
    let mut cos = 1.0 + z * (-0.5 + z * (1.0 / 24.0 + z * (-1.0 / 720.0 + z * cos_end)));
    let sinc_end =
        1.0 / 362_880.0 + z * (-1.0 / 39_916_800.0 + z * (1.0 / 6_227_020_800.0 + z * (-1.0 / 1_307_674_368_000.0)));
    let mut sinc = 1.0 + z * (-1.0 / 6.0 + z * (1.0 / 120.0 + z * (-1.0 / 5040.0 + z * sinc_end)));
    for _ in 0..H {
        sinc *= cos;
        cos = 2.0 * cos * cos - 1.0;
    }
    (cos, sinc)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coating::versine;
    use crate::{Coating, Stack, StackLayer};
    use spectra_core::math;
    use std::sync::Arc;

    /// Returns directions in one plane, in front of and behind a surface along z; `None` on total reflection.
    fn directions(n: f64, n_after: f64, angle_deg: f64) -> Option<[[f64; 3]; 2]> {
        let (sin, cos) = (math::sin(angle_deg.to_radians()), math::cos(angle_deg.to_radians()));
        let after = n / n_after * sin;
        (after < 1.0).then(|| [[sin, 0.0, cos], [after, 0.0, (1.0 - after * after).sqrt()]])
    }

    /// Compares every pair of media, angle and wavelength of the band with [`Coating::transmittance`].
    fn agrees<const N: usize, const H: usize>(coating: &Coating, layers: &[[f64; 2]; N], shortest_nm: f64) {
        let films = Films::new(layers);
        let mut worst = 0.0_f64;
        let media = [(1.0, 1.5168), (1.0, 1.9), (1.0, 1.33), (1.7, 1.0), (1.6, 1.7), (1.7, 1.6), (1.7, 1.7001)];
        for (n, n_after) in media {
            let halvings = films.halvings(shortest_nm, f64::min(n, n_after)).expect("thin");
            assert!(halvings as usize <= H, "{halvings} {H}");
            for angle_deg in (0..90).map(f64::from) {
                let Some([before, after]) = directions(n, n_after, angle_deg) else { continue };
                let sides = Sides::of(n, n_after, versine(before, after));
                for nm in (shortest_nm as u32..=1100).step_by(7).map(f64::from) {
                    let want = coating.transmittance(n, n_after, before[2], nm).mean();
                    let got = films.passes::<H>(&sides, 1.0 / nm);
                    worst = worst.max((got - want).abs());
                }
            }
        }
        assert!(worst < 1e-10, "{N} layers: {worst:e}");
    }

    #[test]
    fn clear_layers_are_the_exact_formula() {
        let layer = |[index, nm]: [f64; 2]| StackLayer::constant(nm, index, 0.0);
        let stack =
            |layers: &[[f64; 2]]| Coating::Stack(Arc::new(Stack::new(layers.iter().map(|l| layer(*l)).collect())));
        let one = [[1.38, 99.6]];
        agrees::<1, 1>(&Coating::Layer { index: 1.38, thickness_nm: 99.6 }, &one, 380.0);
        agrees::<1, 2>(&stack(&one), &one, 300.0);
        let quarter = |n: f64| [n, 515.0 / 4.0 / n];
        let two = [quarter(1.38), quarter(1.72)];
        agrees::<2, 2>(&stack(&two), &two, 350.0);
        let three = [quarter(1.38), [2.1, 122.6], quarter(1.72)];
        agrees::<3, 2>(&stack(&three), &three, 400.0);
        agrees::<3, 3>(&stack(&three), &three, 200.0);
        // Layers so thick that many orders lie in the band, and of so low an index that light decays in them.
        agrees::<1, 5>(&stack(&[[1.5, 1500.0]]), &[[1.5, 1500.0]], 380.0);
        agrees::<1, 3>(&stack(&[[1.0, 400.0]]), &[[1.0, 400.0]], 380.0);
        assert_eq!(Films::new(&[[1.5, 1e6]]).halvings(380.0, 1.0), None);
        assert_eq!(Films::new(&[[1.5, f64::NAN]]).halvings(380.0, 1.0), None);
        assert_eq!(Films::new(&[[1.5, f64::NAN], [1.5, 100.0]]).halvings(380.0, 1.0), None);
        assert_eq!(Films::new(&[[f64::NAN, 100.0]]).halvings(380.0, 1.0), None);
        assert_eq!(Films::new(&[[1.5, 100.0]]).halvings(f64::NAN, 1.0), None);
    }

    #[test]
    fn bare_glass_is_the_exact_formula() {
        for (n, n_after) in [(1.0, 1.5168), (1.9, 1.0), (1.6, 1.7), (1.7, 1.7001), (1.7, 1.700_000_1)] {
            for angle_deg in (0..90).map(f64::from) {
                let Some([before, after]) = directions(n, n_after, angle_deg) else { continue };
                let want = Coating::Bare.transmittance(n, n_after, before[2], 550.0).mean();
                let sides = Sides::of(n, n_after, versine(before, after));
                assert!((sides.bare() - want).abs() < 1e-13, "{n} {n_after} {angle_deg}: {} {want}", sides.bare());
                assert!((sides.cosine() - before[2]).abs() < 1e-8, "{n} {n_after} {angle_deg}");
            }
        }
    }
}
