//! Any stack of thin layers, computed with the characteristic matrix.
//!
//! The method is by F. Abeles, as in H. A. Macleod, "Thin-Film Optical Filters", chapter 2, and Born and Wolf, section 1.6.2. Each layer of
//! complex index N = n - i k has the phase thickness delta = 2 pi N d cos(theta) / lambda and the matrix
//! [[cos delta, i sin delta / eta], [i eta sin delta, cos delta]]. Here eta = N cos(theta) for the electric field across the
//! plane of incidence and N / cos(theta) in it. (B, C) is the product of all matrices times (1, eta'), and
//! T = 4 eta eta' / |eta B + C|^2. T is the same from both sides, absorbing layers included.

use super::{Reflectance, Transmittance};
use spectra_core::math;
use std::ops::{Add, Div, Mul};

/// First wavelength of the tables of indices, nm.
const FROM_NM: f64 = 200.0;
/// Last wavelength of the tables of indices, nm.
const TO_NM: f64 = 2500.0;
/// Imaginary part of the phase above which a layer lets nothing through.
const OPAQUE: f64 = 300.0;

/// One layer of a stack: its thickness and its complex index.
#[derive(Clone, Debug, PartialEq)]
pub struct StackLayer {
    thickness_nm: f64,
    /// n and k for each nanometer from [`FROM_NM`]; one pair if both are the same at all wavelengths.
    index: Vec<[f64; 2]>,
}

impl StackLayer {
    /// Creates a layer of this thickness (nm) with the same index n - i k at all wavelengths.
    #[must_use]
    pub fn constant(thickness_nm: f64, n: f64, k: f64) -> Self {
        Self { thickness_nm, index: vec![[n, k]] }
    }

    /// Creates a layer of this thickness (nm). `n_and_k` returns its n and k at a wavelength (nm), of which a table is made.
    #[must_use]
    pub fn dispersive(thickness_nm: f64, n_and_k: impl Fn(f64) -> [f64; 2]) -> Self {
        let count = (TO_NM - FROM_NM) as usize + 1;
        Self { thickness_nm, index: (0..count).map(|i| n_and_k(FROM_NM + i as f64)).collect() }
    }

    fn at(&self, wavelength_nm: f64) -> Complex {
        let last = self.index.len() - 1;
        let place = (wavelength_nm - FROM_NM).clamp(0.0, last as f64);
        let i = (place as usize).min(last.saturating_sub(1));
        let t = place - i as f64;
        let ([n0, k0], [n1, k1]) = (self.index[i], self.index[(i + 1).min(last)]);
        Complex { re: n0 + t * (n1 - n0), im: -(k0 + t * (k1 - k0)) }
    }
}

/// The layers on a surface, in order. The first one is next to the air, or to the medium of the lower index.
#[derive(Clone, Debug, PartialEq)]
pub struct Stack {
    layers: Vec<StackLayer>,
}

impl Stack {
    /// Creates a stack of layers, the first one next to the air.
    #[must_use]
    pub fn new(layers: Vec<StackLayer>) -> Self {
        Self { layers }
    }

    /// Number of layers in the stack.
    #[must_use]
    pub fn len(&self) -> usize {
        self.layers.len()
    }

    /// Returns whether the stack has no layers, which is bare glass.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.layers.is_empty()
    }

    /// Returns the index and the thickness (nm) of each layer. `None` unless there are `N` layers that neither absorb nor
    /// disperse.
    pub fn clear_layers<const N: usize>(&self) -> Option<[[f64; 2]; N]> {
        let clear = |layer: &StackLayer| match layer.index[..] {
            [[n, 0.0]] => Some([n, layer.thickness_nm]),
            _ => None,
        };
        let layers: Vec<[f64; 2]> = self.layers.iter().map(clear).collect::<Option<_>>()?;
        layers.try_into().ok()
    }

    /// Returns the transmittance between two media at a wavelength, nm. The first array holds the indices of the two media, the
    /// second the cosines of the angles in them.
    #[must_use]
    pub fn transmittance(&self, [n, n_after]: [f64; 2], [c, c_after]: [f64; 2], wavelength_nm: f64) -> Transmittance {
        let tangential = n * n * (1.0 - c * c);
        // Light that comes out of the glass meets the last layer first, but the same fraction passes in both directions.
        let (n, c, n_after, c_after) = if n <= n_after { (n, c, n_after, c_after) } else { (n_after, c_after, n, c) };
        let (front, back) = (ends(n, c), ends(n_after, c_after));
        let Some([s, p]) = self.admittance(self.layers.iter().rev(), tangential, back.map(real), wavelength_nm) else {
            return Transmittance { s: 0.0, p: 0.0 };
        };
        let through = |[b, c]: [Complex; 2], eta: f64, eta_after: f64| {
            let down = b * real(eta) + c;
            4.0 * eta * eta_after / down.size2()
        };
        Transmittance { s: through(s, front[0], back[0]), p: through(p, front[1], back[1]) }
    }

    /// Returns the reflectance for light that arrives in the first medium, with arguments as for [`Stack::transmittance`]. An
    /// absorbing stack has different reflectances on its two sides.
    #[must_use]
    pub fn reflectance(&self, indices: [f64; 2], [c, _]: [f64; 2], wavelength_nm: f64) -> Reflectance {
        let [s, p] = self.amplitudes(indices, c, wavelength_nm).map(|[_, back]| back.size2());
        Reflectance { s, p }
    }

    /// Computes the amplitudes of transmitted and reflected light, for s and for p light that arrives in a medium of index `n` at this
    /// cosine. They are amplitudes of the tangential fields. Transmitted amplitudes are scaled so that their squares are fractions of the
    /// power; they are 0 on total reflection.
    pub(super) fn amplitudes(&self, [n, n_after]: [f64; 2], c: f64, wavelength_nm: f64) -> [[Complex; 2]; 2] {
        let tangential = n * n * (1.0 - c * c);
        // N cos(theta) behind the stack; the conjugate makes an evanescent wave decay in this direction.
        let along = real(n_after * n_after - tangential).sqrt().conjugate();
        let front = ends(n, c);
        let back =
            if along.size2() > 0.0 { [along, real(n_after * n_after) / along] } else { ends(n_after, 0.0).map(real) };
        // The layers are taken from the far side; the first layer is the one next to the air.
        let sums = if n <= n_after {
            self.admittance(self.layers.iter().rev(), tangential, back, wavelength_nm)
        } else {
            self.admittance(self.layers.iter(), tangential, back, wavelength_nm)
        };
        // With an opaque layer nothing behind it matters, but its own admittance would be needed. It counts as black here.
        let Some([s, p]) = sums else { return [[real(0.0); 2]; 2] };
        let of = |[b, c]: [Complex; 2], eta: f64, eta_after: Complex| {
            let down = b * real(eta) + c;
            let through = real(2.0 * (eta * eta_after.re.max(0.0)).sqrt()) / down;
            [through, (b * real(eta) + c.negated()) / down]
        };
        [of(s, front[0], back[0]), of(p, front[1], back[1])]
    }

    /// Computes (B, C) of both polarizations in front of the layers, which are given from the far side on; `None` if a layer is opaque.
    fn admittance<'a>(
        &self,
        layers: impl Iterator<Item = &'a StackLayer>,
        tangential: f64,
        back: [Complex; 2],
        wavelength_nm: f64,
    ) -> Option<[[Complex; 2]; 2]> {
        let start = |eta: Complex| [real(1.0), eta];
        let (mut s, mut p) = (start(back[0]), start(back[1]));
        for layer in layers {
            let index = layer.at(wavelength_nm);
            let square = index * index;
            // N cos(theta): the sign of the root does not matter, because everything that follows is even in it.
            let along = (square + real(-tangential)).sqrt();
            let turn = std::f64::consts::TAU * layer.thickness_nm / wavelength_nm;
            let delta = Complex { re: along.re * turn, im: along.im * turn };
            if !(delta.im.abs() < OPAQUE) {
                return None;
            }
            let (cos, sin) = delta.cos_sin();
            // sin(delta) / (N cos(theta)), which stays finite at the critical angle of the layer.
            let over = if along.size2() > 1e-24 { sin / along } else { real(turn) };
            s = pass(s, cos, over, sin * along);
            p = pass(p, cos, sin * along / square, over * square);
        }
        Some([s, p])
    }
}

/// Admittances of a medium of index `n` for a ray of this cosine: for s and for p light.
fn ends(n: f64, c: f64) -> [f64; 2] {
    [n * c, n / c.max(1e-12)]
}

fn real(re: f64) -> Complex {
    Complex { re, im: 0.0 }
}

/// Multiplies (B, C) by the matrix of a layer: `over` is sin(delta) / eta, `times` is eta sin(delta).
fn pass([b, c]: [Complex; 2], cos: Complex, over: Complex, times: Complex) -> [Complex; 2] {
    [cos * b + over.turned() * c, times.turned() * b + cos * c]
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Complex {
    pub(super) re: f64,
    pub(super) im: f64,
}

impl Complex {
    pub(super) fn size2(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    pub(super) fn conjugate(self) -> Self {
        Self { re: self.re, im: -self.im }
    }

    pub(super) fn negated(self) -> Self {
        Self { re: -self.re, im: -self.im }
    }

    /// Multiplies the number by i.
    fn turned(self) -> Self {
        Self { re: -self.im, im: self.re }
    }

    /// Returns the square root whose real part is not negative.
    fn sqrt(self) -> Self {
        let size = self.size2().sqrt();
        let re = (0.5 * (size + self.re)).max(0.0).sqrt();
        let im = (0.5 * (size - self.re)).max(0.0).sqrt();
        Self { re, im: if self.im < 0.0 { -im } else { im } }
    }

    fn cos_sin(self) -> (Self, Self) {
        let (sin, cos) = (math::sin(self.re), math::cos(self.re));
        let (up, down) = (math::exp(self.im), math::exp(-self.im));
        let (sinh, cosh) = (0.5 * (up - down), 0.5 * (up + down));
        (Self { re: cos * cosh, im: -sin * sinh }, Self { re: sin * cosh, im: cos * sinh })
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self { re: self.re + o.re, im: self.im + o.im }
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self { re: self.re * o.re - self.im * o.im, im: self.re * o.im + self.im * o.re }
    }
}

impl Div for Complex {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        let size2 = o.size2();
        Self { re: (self.re * o.re + self.im * o.im) / size2, im: (self.im * o.re - self.re * o.im) / size2 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Coating;

    fn cosines(n: f64, n_after: f64, c: f64) -> Option<[f64; 2]> {
        let square = 1.0 - (n / n_after) * (n / n_after) * (1.0 - c * c);
        (square > 0.0).then(|| [c, square.sqrt()])
    }

    /// One layer matches the closed form of one layer, and no layer matches Fresnel's equations; also if light only decays in the layer.
    #[test]
    fn one_layer_and_none() {
        for (n, n_after) in [(1.0, 1.5168), (1.7, 1.0), (1.5, 1.5)] {
            for step in 0..20 {
                let c = 1.0 - 0.04 * f64::from(step);
                let Some(both) = cosines(n, n_after, c) else { continue };
                for (index, thickness_nm) in [(1.38, 99.6), (2.1, 250.0), (1.0, 120.0)] {
                    let stack = Stack::new(vec![StackLayer::constant(thickness_nm, index, 0.0)]);
                    let want = Coating::Layer { index, thickness_nm }.transmittance(n, n_after, c, 550.0);
                    let got = stack.transmittance([n, n_after], both, 550.0);
                    assert!((got.s - want.s).abs() < 1e-11 && (got.p - want.p).abs() < 1e-11, "{got:?} {want:?} {c}");
                }
                let bare = Stack::new(Vec::new()).transmittance([n, n_after], both, 550.0);
                let want = Coating::Bare.transmittance(n, n_after, c, 550.0);
                assert!((bare.s - want.s).abs() < 1e-13 && (bare.p - want.p).abs() < 1e-13);
            }
        }
    }

    /// A quarter-wave mirror of p pairs with the high index on both sides reflects ((1 - Y) / (1 + Y))^2 with Y = (high / low)^(2 p) high^2
    /// / n' (Macleod, section 5.1, eq. 5.1). Here 2.35 and 1.35 on 1.52, four pairs and one more layer.
    #[test]
    fn a_quarter_wave_mirror() {
        let (high, low, glass, wave) = (2.35_f64, 1.35_f64, 1.52, 550.0);
        let quarter = |n: f64| StackLayer::constant(wave / 4.0 / n, n, 0.0);
        let mut layers = vec![quarter(high)];
        for _ in 0..4 {
            layers.extend([quarter(low), quarter(high)]);
        }
        let got = 1.0 - Stack::new(layers).transmittance([1.0, glass], [1.0, 1.0], wave).mean();
        let y = (high / low).powi(8) * high * high / glass;
        let want = ((1.0 - y) / (1.0 + y)).powi(2);
        assert!((got - want).abs() < 1e-12, "{got} {want}");
    }

    /// A thin film of silver absorbs: 20 nm of n = 0.055, k = 3.32 between air and glass of 1.52 at 550 nm. The reference is the
    /// sum over all bounces in complex numbers (Born and Wolf 1.6.4, eq. 58), computed separately with 30 digits.
    #[test]
    fn metal_absorbs_and_passes_alike_from_both_sides() {
        let silver = Stack::new(vec![StackLayer::constant(20.0, 0.055, 3.32)]);
        let there = silver.transmittance([1.0, 1.52], [1.0, 1.0], 550.0).mean();
        assert!((there - SILVER).abs() < 1e-9, "{there}");
        let both = cosines(1.0, 1.52, 0.7).expect("refracts");
        let there = silver.transmittance([1.0, 1.52], both, 550.0);
        let back = silver.transmittance([1.52, 1.0], [both[1], both[0]], 550.0);
        assert!((there.s - back.s).abs() < 1e-13 && (there.p - back.p).abs() < 1e-13);
    }

    const SILVER: f64 = 0.358_103_297_998_037_7;
}
