//! Transmission of clear layers in single precision, for rendering: twice as many rays per instruction as with [`Films`].
//!
//! The formulas are those of [`Films`], but the *reflected* fraction is computed and subtracted from the weight:
//! R = ((eta a - eta' d)^2 + (eta eta' x - y)^2) / ((eta a + eta' d)^2 + (eta eta' x + y)^2).
//! Because R is small, its error is small, too: the transmission is within 1e-6 of the exact formula, as tests check. Where R is large
//! (grazing light, layers of many orders) [`Films`] is used, which is within 1e-10.
//!
//! Polynomials in wavelength and angle of that accuracy would have as many terms as the closed form has operations. Tables would wait for
//! memory.

use super::Films;
use super::films::times;

/// Upper limit of the error of the transmission.
#[cfg(test)]
pub const SWIFT_ERROR: f64 = 1e-6;

/// Largest square of delta / 2^H for which the polynomials of [`cos_and_sinc`] hold.
const REACH: f64 = 6.25;
/// Largest number of halvings. Each one makes the error four times as large.
const MOST_HALVINGS: u32 = 1;

/// Number of rays that are computed side by side.
pub const CHUNK: usize = 64;
/// A column of [`CHUNK`] values in single precision.
pub type Singles = [f32; CHUNK];

/// A stack of clear layers like [`Films`], in single precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmsF32<const N: usize> {
    square: [f32; N],
    per_square: [f32; N],
    turn_nm: [f32; N],
    /// One over 4^H.
    scale: f32,
    halvings: u32,
}

impl<const N: usize> FilmsF32<N> {
    /// Converts layers to single precision, for wavelengths of `shortest_nm` or longer. `low` is the lower index of the two
    /// media. Returns `None` if single precision is not accurate enough.
    pub fn of(films: &Films<N>, shortest_nm: f64, low: f64) -> Option<Self> {
        let largest = |h: u32| REACH * f64::from(1_u32 << (2 * h));
        let good = |h: &u32| {
            (0..N).all(|k| {
                let turn = films.turn_nm[k] / shortest_nm;
                turn * turn * films.square[k] <= largest(*h) && films.square[k] > low * low
            })
        };
        let halvings = (0..=MOST_HALVINGS).find(good)?;
        let [square, per_square, turn_nm] =
            [films.square, films.per_square, films.turn_nm].map(|column| column.map(|value| value as f32));
        Some(Self { square, per_square, turn_nm, scale: 1.0 / (1_u32 << (2 * halvings)) as f32, halvings })
    }

    /// Computes the fraction of unpolarized light that is reflected. `h` and the indices are defined at the head of `films.rs`; `per_nm` is
    /// one over the wavelength, 1/nm.
    #[inline(always)]
    pub fn reflects(&self, n: f32, n_after: f32, h: f32, per_nm: f32) -> f32 {
        let step = n_after - n;
        let (u, v) = (step - n_after * h, step + n * h);
        let both = n * n_after;
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
            let (cos, sinc) = cos_and_sinc(turn * turn * along2 * self.scale);
            // One halving or none.
            let (cos, sinc) = if self.halvings > 0 { (2.0 * cos * cos - 1.0, sinc * cos) } else { (cos, sinc) };
            let over = sinc * turn;
            let next_s = [cos, over, along2 * over, cos];
            let next_p = [cos, along2 * over * self.per_square[k], self.square[k] * over, cos];
            (s, p) = if k == 0 { (next_s, next_p) } else { (times(s, next_s), times(p, next_p)) };
        }
        // Squares of the sum and of the difference.
        let squares = |re: [f32; 2], im: [f32; 2]| {
            let (re_sum, im_sum) = (re[0] + re[1], im[0] + im[1]);
            let (re_less, im_less) = (re[0] - re[1], im[0] - im[1]);
            (re_sum * re_sum * per_g2 + im_sum * im_sum, re_less * re_less * per_g2 + im_less * im_less)
        };
        let [a, x, y, d] = s;
        let (all_s, back_s) = squares([low * u_low * a, high * u_high * d], [both * cosines * x, y]);
        let [a, x, y, d] = p;
        let (all_p, back_p) = squares([low * u_high * a, high * u_low * d], [both * x, cosines * y]);
        0.5 * (back_s * all_p + back_p * all_s) / (all_s * all_p)
    }
}

/// Computes cos(delta) and sin(delta) / delta from the square of delta, 0 to [`REACH`]. The polynomials interpolate at Chebyshev's nodes
/// and are within 6e-8 and 5e-9, apart from rounding.
#[inline(always)]
fn cos_and_sinc(z: f32) -> (f32, f32) {
    let cos = 0.999_999_95
        + z * (-0.499_999_37
            + z * (0.041_665_485 + z * (-1.388_077_8e-3 + z * (2.454_880_8e-5 + z * -2.388_531_7e-7))));
    let sinc = 1.0
        + z * (-0.166_666_62
            + z * (8.333_241_2e-3 + z * (-1.983_495_1e-4 + z * (2.736_064_8e-6 + z * -2.220_337_2e-8))));
    (cos, sinc)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Coating, Stack, StackLayer};
    use spectra_core::math;
    use std::sync::Arc;

    /// Compares every pair of media, angle and wavelength of the band with [`Coating::transmittance`]. Returns the largest difference and
    /// the mean difference.
    fn differences<const N: usize>(layers: [[f64; 2]; N], shortest_nm: f64) -> (f64, f64) {
        let films = Films::new(&layers);
        let stack = layers.iter().map(|[index, nm]| StackLayer::constant(*nm, *index, 0.0)).collect();
        let coating = Coating::Stack(Arc::new(Stack::new(stack)));
        let (mut worst, mut sum, mut count) = (0.0_f64, 0.0, 0.0);
        for (n, n_after) in [(1.0, 1.5168), (1.0, 1.9), (1.0, 1.33), (1.7, 1.0), (1.52, 1.0), (1.0003, 1.62)] {
            let swift = FilmsF32::of(&films, shortest_nm, f64::min(n, n_after)).expect("thin");
            for angle_deg in (0..360).map(|quarter| 0.25 * f64::from(quarter)) {
                let (sin, cos) = (math::sin(angle_deg.to_radians()), math::cos(angle_deg.to_radians()));
                let after = n / n_after * sin;
                if after >= 1.0 {
                    continue;
                }
                let cos_after = (1.0 - after * after).sqrt();
                let turn = [after - sin, cos_after - cos];
                let h = 0.5 * (turn[0] * turn[0] + turn[1] * turn[1]);
                for nm in (shortest_nm as u32..=1100).step_by(13).map(f64::from) {
                    let want = coating.transmittance(n, n_after, cos, nm).mean();
                    let back = swift.reflects(n as f32, n_after as f32, h as f32, 1.0 / nm as f32);
                    let miss = 1.0 - f64::from(back) - want;
                    worst = worst.max(miss.abs());
                    (sum, count) = (sum + miss, count + 1.0);
                }
            }
        }
        (worst, sum / count)
    }

    #[test]
    fn layers_in_single_precision_are_as_good_as_stated() {
        let quarter = |n: f64| [n, 515.0 / 4.0 / n];
        let three = [quarter(1.38), [2.1, 515.0 / 2.0 / 2.1], quarter(1.72)];
        for (worst, mean) in [
            differences([[1.38, 550.0 / 4.0 / 1.38]], 350.0),
            differences([[1.38, 99.6]], 300.0),
            differences([quarter(1.38), quarter(1.72)], 350.0),
            differences(three, 350.0),
        ] {
            // Rounding errors have no bias.
            assert!(worst < SWIFT_ERROR && mean.abs() < 0.1 * SWIFT_ERROR, "{worst:e}, {mean:e} in the mean");
        }
    }

    /// Thick layers, and layers in which light may decay, are left to double precision.
    #[test]
    fn what_single_precision_is_no_good_for() {
        let swift =
            |layers: [[f64; 2]; 1], shortest_nm: f64, low: f64| FilmsF32::of(&Films::new(&layers), shortest_nm, low);
        assert!(swift([[1.38, 99.6]], 350.0, 1.0).is_some());
        assert!(swift([[1.5, 1500.0]], 380.0, 1.0).is_none());
        assert!(swift([[1.38, 99.6]], 350.0, 1.5).is_none());
        assert!(swift([[f64::NAN, 99.6]], 350.0, 1.0).is_none());
        assert!(swift([[1.38, 99.6]], f64::NAN, 1.0).is_none());
    }
}
