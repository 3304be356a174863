//! The discrete Fourier transform of a power of two of complex numbers, eight columns at once.
//!
//! Own code rather than a crate's, so that a picture has the same bits on every machine: twiddle factors come from
//! [`crate::math`], the order of operations is fixed, and the eight columns are what the compiler turns into vectors
//! of any width without changing a bit.
//!
//! The forward transform decimates in frequency and leaves its result in digit-reversed order, the inverse decimates in
//! time and takes it so (W. M. Gentleman and G. Sande, "Fast Fourier transforms for fun and profit", AFIPS 1966): a
//! convolution, which multiplies two spectra in the same order, needs no reordering.

use crate::math::{cos, sin};

/// Columns that are transformed together.
pub(super) const LANES: usize = 8;

/// One number of each column.
pub(super) type Lane = [f64; LANES];

/// Transforms of one length.
#[derive(Clone, Debug)]
pub(super) struct Fft {
    length: usize,
    /// exp(-2 pi i k / length).
    twiddles: Vec<[f64; 2]>,
}

impl Fft {
    /// A plan for `length`, a power of two.
    pub(super) fn new(length: usize) -> Self {
        assert!(length.is_power_of_two(), "{length} is no power of two");
        let turn = |k: usize| -std::f64::consts::TAU * k as f64 / length as f64;
        let twiddles = (0..length).map(|k| [cos(turn(k)), sin(turn(k))]).collect();
        Self { length, twiddles }
    }

    pub(super) fn length(&self) -> usize {
        self.length
    }

    /// Forward, not scaled; the result is in digit-reversed order.
    #[inline(always)]
    pub(super) fn forward(&self, re: &mut [Lane], im: &mut [Lane]) {
        let (re, im) = (&mut re[..self.length], &mut im[..self.length]);
        let mut span = self.length;
        while span >= 4 {
            let quarter = span / 4;
            let stride = self.length / span;
            for base in (0..self.length).step_by(span) {
                let (r0, r1, r2, r3) = quarters(&mut re[base..base + span], quarter);
                let (i0, i1, i2, i3) = quarters(&mut im[base..base + span], quarter);
                for k in 0..quarter {
                    let w1 = self.twiddles[k * stride];
                    let w2 = self.twiddles[2 * k * stride];
                    let w3 = self.twiddles[3 * k * stride];
                    for l in 0..LANES {
                        let (a, b) = (r0[k][l] + r2[k][l], i0[k][l] + i2[k][l]);
                        let (c, d) = (r0[k][l] - r2[k][l], i0[k][l] - i2[k][l]);
                        let (e, f) = (r1[k][l] + r3[k][l], i1[k][l] + i3[k][l]);
                        let (g, h) = (r1[k][l] - r3[k][l], i1[k][l] - i3[k][l]);
                        r0[k][l] = a + e;
                        i0[k][l] = b + f;
                        (r1[k][l], i1[k][l]) = times(c + h, d - g, w1);
                        (r2[k][l], i2[k][l]) = times(a - e, b - f, w2);
                        (r3[k][l], i3[k][l]) = times(c - h, d + g, w3);
                    }
                }
            }
            span = quarter;
        }
        if span == 2 {
            halves(re, im);
        }
    }

    /// Inverse of [`Fft::forward`] but for the factor `length`.
    #[inline(always)]
    pub(super) fn inverse(&self, re: &mut [Lane], im: &mut [Lane]) {
        let (re, im) = (&mut re[..self.length], &mut im[..self.length]);
        let mut span = 1;
        if self.length.trailing_zeros() % 2 == 1 {
            halves(re, im);
            span = 2;
        }
        while span < self.length {
            let quarter = span;
            span *= 4;
            let stride = self.length / span;
            for base in (0..self.length).step_by(span) {
                let (r0, r1, r2, r3) = quarters(&mut re[base..base + span], quarter);
                let (i0, i1, i2, i3) = quarters(&mut im[base..base + span], quarter);
                for k in 0..quarter {
                    let w1 = self.twiddles[k * stride];
                    let w2 = self.twiddles[2 * k * stride];
                    let w3 = self.twiddles[3 * k * stride];
                    for l in 0..LANES {
                        let (p, q) = (r0[k][l], i0[k][l]);
                        let (c, d) = times(r1[k][l], i1[k][l], [w1[0], -w1[1]]);
                        let (e, f) = times(r2[k][l], i2[k][l], [w2[0], -w2[1]]);
                        let (g, h) = times(r3[k][l], i3[k][l], [w3[0], -w3[1]]);
                        let (ar, ai) = (p + e, q + f);
                        let (br, bi) = (p - e, q - f);
                        let (cr, ci) = (c + g, d + h);
                        let (dr, di) = (h - d, c - g); // i (y1 - y3)
                        r0[k][l] = ar + cr;
                        i0[k][l] = ai + ci;
                        r2[k][l] = ar - cr;
                        i2[k][l] = ai - ci;
                        r1[k][l] = br + dr;
                        i1[k][l] = bi + di;
                        r3[k][l] = br - dr;
                        i3[k][l] = bi - di;
                    }
                }
            }
        }
    }

    /// Which frequency, in cycles per `length`, each place of [`Fft::forward`]'s result holds.
    pub(super) fn order(&self) -> Vec<usize> {
        let mut order = vec![0];
        let mut stride = 1;
        let mut span = self.length;
        while span > 1 {
            let radix = if span >= 4 { 4 } else { 2 };
            order = order.iter().flat_map(|f| (0..radix).map(move |r| f + r * stride)).collect();
            stride *= radix;
            span /= radix;
        }
        order
    }
}

/// Quarters of a span.
#[inline(always)]
fn quarters(span: &mut [Lane], quarter: usize) -> (&mut [Lane], &mut [Lane], &mut [Lane], &mut [Lane]) {
    let (a, rest) = span.split_at_mut(quarter);
    let (b, rest) = rest.split_at_mut(quarter);
    let (c, d) = rest.split_at_mut(quarter);
    (a, b, c, &mut d[..quarter])
}

#[inline(always)]
fn times(re: f64, im: f64, w: [f64; 2]) -> (f64, f64) {
    (re * w[0] - im * w[1], re * w[1] + im * w[0])
}

/// The transform of length 2, its own inverse but for the factor.
#[inline(always)]
fn halves(re: &mut [Lane], im: &mut [Lane]) {
    for column in [re, im] {
        for pair in column.chunks_exact_mut(2) {
            for l in 0..LANES {
                (pair[0][l], pair[1][l]) = (pair[0][l] + pair[1][l], pair[0][l] - pair[1][l]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transform_is_the_sum_that_defines_it() {
        for length in [1, 2, 4, 8, 16, 32, 128] {
            let fft = Fft::new(length);
            let value = |k: usize, l: usize| (sin((k * 7 + l) as f64), cos((k * k + 3 * l) as f64));
            let lane = |f: &dyn Fn(usize, usize) -> f64| -> Vec<Lane> {
                (0..length).map(|k| std::array::from_fn(|l| f(k, l))).collect()
            };
            let mut re = lane(&|k, l| value(k, l).0);
            let mut im = lane(&|k, l| value(k, l).1);
            fft.forward(&mut re, &mut im);
            let order = fft.order();
            for (place, frequency) in order.iter().enumerate() {
                for l in [0, 5] {
                    let (mut r, mut i) = (0.0, 0.0);
                    for k in 0..length {
                        let angle = -std::f64::consts::TAU * ((k * frequency) % length) as f64 / length as f64;
                        let (dr, di) = times(value(k, l).0, value(k, l).1, [cos(angle), sin(angle)]);
                        r += dr;
                        i += di;
                    }
                    assert!((re[place][l] - r).abs() + (im[place][l] - i).abs() < 1e-12, "{length} {frequency}");
                }
            }
            fft.inverse(&mut re, &mut im);
            for k in 0..length {
                for l in 0..LANES {
                    let (r, i) = value(k, l);
                    let n = length as f64;
                    assert!((re[k][l] / n - r).abs() + (im[k][l] / n - i).abs() < 1e-14, "{length} {k}");
                }
            }
        }
    }
}
