//! Encodes linear light as 8-bit sRGB by comparison. The power of the curve costs more than everything else that is done for a pixel of a
//! file.

use spectra_color::{Transfer, to_u8};
use std::sync::OnceLock;

/// Number of low bits of an `f32` that share a bin: an octave has 128 bins, and each bin spans at most two code values.
const BIN: u32 = 16;

/// Thresholds of the 8-bit sRGB code values.
pub(super) struct Srgb8Table {
    /// Smallest light of each code value.
    begins: Vec<f32>,
    /// Code value of the smallest light of each bin, up to 1.
    of_bin: Vec<u8>,
}

fn exact(linear: f32) -> u8 {
    to_u8(Transfer::Srgb.encode(f64::from(linear)))
}

impl Srgb8Table {
    /// Returns the shared table.
    pub(super) fn srgb() -> &'static Self {
        static ONE: OnceLock<Srgb8Table> = OnceLock::new();
        ONE.get_or_init(|| {
            let begin = |code: u8| {
                // Positive floating-point numbers sort like their bits.
                let (mut below, mut from) = (0, 1.0_f32.to_bits());
                while from - below > 1 {
                    let middle = below + (from - below) / 2;
                    if exact(f32::from_bits(middle)) >= code { from = middle } else { below = middle }
                }
                f32::from_bits(from)
            };
            let begins = (0..=u8::MAX).map(|code| if code == 0 { 0.0 } else { begin(code) }).collect();
            let of_bin = (0..=1.0_f32.to_bits() >> BIN).map(|bin| exact(f32::from_bits(bin << BIN))).collect();
            Self { begins, of_bin }
        })
    }

    /// Converts linear light to a code value, clipped; NaN becomes 0.
    #[inline(always)]
    pub(super) fn code(&self, linear: f32) -> u8 {
        if linear.is_nan() || linear <= 0.0 {
            return 0;
        }
        if linear >= 1.0 {
            return u8::MAX;
        }
        let mut code = self.of_bin[(linear.to_bits() >> BIN) as usize];
        while code < u8::MAX && linear >= self.begins[usize::from(code) + 1] {
            code += 1;
        }
        code
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with the exact curve on both sides of every step, and between steps.
    #[test]
    fn codes_are_those_of_the_curve() {
        let eight = Srgb8Table::srgb();
        let near = |v: f32| (-3..=3).map(move |d: i32| f32::from_bits((v.to_bits() as i32 + d).max(0) as u32));
        let even = (0..200_000).map(|i| f32::from_bits(i * 5323));
        let odd = [-0.0, -1.0, 1.0, 2.5, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MIN_POSITIVE, 1e-40];
        let steps: Vec<f32> = eight.begins[1..].iter().flat_map(|v| near(*v)).collect();
        for v in steps.into_iter().chain(even).chain(odd) {
            assert_eq!(eight.code(v), exact(v), "{v:e}");
        }
        assert!(eight.begins.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
