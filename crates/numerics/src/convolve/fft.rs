//! The discrete Fourier transform of a power of two of complex numbers, sixteen columns at once.
//!
//! This is our own code rather than a crate's, so that a picture has the same bits on every machine. Twiddle factors come from
//! [`crate::math`], the order of operations is fixed, and the compiler turns the columns into vectors of any width without
//! changing a bit.
//!
//! The forward transform decimates in frequency and leaves its result in digit-reversed order. The inverse decimates in time
//! and takes that order (W. M. Gentleman and G. Sande, "Fast Fourier transforms for fun and profit", AFIPS 1966). A convolution
//! multiplies two spectra in the same order, so it needs no reordering.

use super::real::Real;
use crate::math::{cos, sin};

/// Number of columns that are transformed together.
pub(super) const LANES: usize = 16;

/// One number of each column.
pub(super) type Lane<T> = [T; LANES];

/// Size (bytes) of the part of a transform that is computed as a whole before the next part: half of the nearest cache.
const NEAR_BYTES: usize = 1 << 14;

/// Transforms of one length.
#[derive(Clone, Debug)]
pub(super) struct Fft<T> {
    length: usize,
    /// exp(-2 pi i k / length).
    twiddles: Vec<[T; 2]>,
}

impl<T: Real> Fft<T> {
    /// Creates a plan for `length`, a power of two of at least 4.
    pub(super) fn new(length: usize) -> Self {
        assert!(length.is_power_of_two() && length >= 4, "{length} is not a power of two of at least 4");
        let turn = |k: usize| -std::f64::consts::TAU * k as f64 / length as f64;
        let twiddles = (0..length).map(|k| [cos(turn(k)), sin(turn(k))].map(T::of)).collect();
        Self { length, twiddles }
    }

    pub(super) fn length(&self) -> usize {
        self.length
    }

    /// Returns the length of the longest part of a transform that fits into [`NEAR_BYTES`].
    fn near(&self) -> usize {
        let most = (NEAR_BYTES / size_of::<Lane<T>>()).max(8);
        let mut span = self.length;
        while span > most {
            span /= 4;
        }
        span
    }

    /// Returns whether the length is not a power of four: the last step is then on spans of 8.
    fn has_eights(&self) -> bool {
        self.length.trailing_zeros() % 2 == 1
    }

    /// Transforms forward, without scaling; the result is in digit-reversed order.
    #[inline(always)]
    pub(super) fn forward(&self, re: &mut [Lane<T>], im: &mut [Lane<T>]) {
        let (re, im) = (&mut re[..self.length], &mut im[..self.length]);
        let near = self.near();
        self.steps_forward(re, im, self.length, near);
        for (re, im) in re.chunks_exact_mut(near).zip(im.chunks_exact_mut(near)) {
            if self.has_eights() {
                self.steps_forward(re, im, near, 8);
                self.eights_forward(re, im);
            } else {
                self.steps_forward(re, im, near, 1);
            }
        }
    }

    /// Does the last steps, on spans of 8: one with quarters of 2, and one of pairs. Doing both together gives the compiler
    /// enough work per lane, so that it leaves lanes side by side.
    #[inline(always)]
    fn eights_forward(&self, re: &mut [Lane<T>], im: &mut [Lane<T>]) {
        let stride = self.length / 8;
        let w = [self.twiddles[stride], self.twiddles[2 * stride], self.twiddles[3 * stride]];
        let one = [self.twiddles[0]; 3];
        for (re, im) in re.chunks_exact_mut(8).zip(im.chunks_exact_mut(8)) {
            for l in 0..LANES {
                let quarters = |k: usize, w: [[T; 2]; 3]| {
                    let [r0, r1, r2, r3] = [0, 2, 4, 6].map(|at| re[at + k][l]);
                    let [i0, i1, i2, i3] = [0, 2, 4, 6].map(|at| im[at + k][l]);
                    let (a, b) = (r0 + r2, i0 + i2);
                    let (c, d) = (r0 - r2, i0 - i2);
                    let (e, f) = (r1 + r3, i1 + i3);
                    let (g, h) = (r1 - r3, i1 - i3);
                    [(a + e, b + f), times(c + h, d - g, w[0]), times(a - e, b - f, w[1]), times(c - h, d + g, w[2])]
                };
                let (even, odd) = (quarters(0, one), quarters(1, w));
                for k in 0..4 {
                    let ((a, b), (c, d)) = (even[k], odd[k]);
                    (re[2 * k][l], im[2 * k][l]) = (a + c, b + d);
                    (re[2 * k + 1][l], im[2 * k + 1][l]) = (a - c, b - d);
                }
            }
        }
    }

    /// Does the first steps of the inverse: pairs, then spans of 8.
    #[inline(always)]
    fn eights_inverse(&self, re: &mut [Lane<T>], im: &mut [Lane<T>]) {
        let stride = self.length / 8;
        let back = |k: usize| [self.twiddles[k * stride][0], -self.twiddles[k * stride][1]];
        let (one, w) = ([back(0); 3], [back(1), back(2), back(3)]);
        for (re, im) in re.chunks_exact_mut(8).zip(im.chunks_exact_mut(8)) {
            for l in 0..LANES {
                let sums = [0, 2, 4, 6].map(|at| (re[at][l] + re[at + 1][l], im[at][l] + im[at + 1][l]));
                let differences = [0, 2, 4, 6].map(|at| (re[at][l] - re[at + 1][l], im[at][l] - im[at + 1][l]));
                let quarters = |from: [(T, T); 4], w: [[T; 2]; 3]| {
                    let (p, q) = from[0];
                    let (c, d) = times(from[1].0, from[1].1, w[0]);
                    let (e, f) = times(from[2].0, from[2].1, w[1]);
                    let (g, h) = times(from[3].0, from[3].1, w[2]);
                    let (ar, ai) = (p + e, q + f);
                    let (br, bi) = (p - e, q - f);
                    let (cr, ci) = (c + g, d + h);
                    let (dr, di) = (h - d, c - g); // i (y1 - y3)
                    [(ar + cr, ai + ci), (br + dr, bi + di), (ar - cr, ai - ci), (br - dr, bi - di)]
                };
                let (even, odd) = (quarters(sums, one), quarters(differences, w));
                for k in 0..4 {
                    (re[2 * k][l], im[2 * k][l]) = even[k];
                    (re[2 * k + 1][l], im[2 * k + 1][l]) = odd[k];
                }
            }
        }
    }

    /// Does the steps on spans from `from` down to, but without, `to`.
    #[inline(always)]
    fn steps_forward(&self, re: &mut [Lane<T>], im: &mut [Lane<T>], from: usize, to: usize) {
        let mut span = from;
        while span > to {
            let quarter = span / 4;
            let stride = self.length / span;
            for (re, im) in re.chunks_exact_mut(span).zip(im.chunks_exact_mut(span)) {
                let (r0, r1, r2, r3) = quarters(re, quarter);
                let (i0, i1, i2, i3) = quarters(im, quarter);
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
    }

    /// Inverts [`Fft::forward`], except for the factor `length`.
    #[inline(always)]
    pub(super) fn inverse(&self, re: &mut [Lane<T>], im: &mut [Lane<T>]) {
        let (re, im) = (&mut re[..self.length], &mut im[..self.length]);
        let near = self.near();
        for (re, im) in re.chunks_exact_mut(near).zip(im.chunks_exact_mut(near)) {
            if self.has_eights() {
                self.eights_inverse(re, im);
                self.steps_inverse(re, im, 8, near);
            } else {
                self.steps_inverse(re, im, 1, near);
            }
        }
        self.steps_inverse(re, im, near, self.length);
    }

    /// Does the steps that join spans of `from` into spans of `to`.
    #[inline(always)]
    fn steps_inverse(&self, re: &mut [Lane<T>], im: &mut [Lane<T>], from: usize, to: usize) {
        let mut span = from;
        while span < to {
            let quarter = span;
            span *= 4;
            let stride = self.length / span;
            for (re, im) in re.chunks_exact_mut(span).zip(im.chunks_exact_mut(span)) {
                let (r0, r1, r2, r3) = quarters(re, quarter);
                let (i0, i1, i2, i3) = quarters(im, quarter);
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

    /// Returns the frequency, in cycles per `length`, at each place of the result of [`Fft::forward`].
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

/// The four quarters of a span.
type Quarters<'a, T> = (&'a mut [Lane<T>], &'a mut [Lane<T>], &'a mut [Lane<T>], &'a mut [Lane<T>]);

#[inline(always)]
fn quarters<T>(span: &mut [Lane<T>], quarter: usize) -> Quarters<'_, T> {
    let (a, rest) = span.split_at_mut(quarter);
    let (b, rest) = rest.split_at_mut(quarter);
    let (c, d) = rest.split_at_mut(quarter);
    (a, b, c, &mut d[..quarter])
}

#[inline(always)]
fn times<T: Real>(re: T, im: T, w: [T; 2]) -> (T, T) {
    (re * w[0] - im * w[1], re * w[1] + im * w[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_the_sum_that_defines_it<T: Real>(off: f64) {
        for length in [4, 8, 16, 32, 128, 1024, 2048] {
            let fft = Fft::<T>::new(length);
            let value = |k: usize, l: usize| (sin((k * 7 + l) as f64), cos((k * k + 3 * l) as f64));
            let lane = |f: &dyn Fn(usize, usize) -> f64| -> Vec<Lane<T>> {
                (0..length).map(|k| std::array::from_fn(|l| T::of(f(k, l)))).collect()
            };
            let mut re = lane(&|k, l| value(k, l).0);
            let mut im = lane(&|k, l| value(k, l).1);
            fft.forward(&mut re, &mut im);
            let order = fft.order();
            let off = off * length as f64;
            for (place, frequency) in order.iter().enumerate().step_by(1 + length / 128) {
                for l in [0, 5] {
                    let (mut r, mut i) = (0.0, 0.0);
                    for k in 0..length {
                        let angle = -std::f64::consts::TAU * ((k * frequency) % length) as f64 / length as f64;
                        let (dr, di) = times(value(k, l).0, value(k, l).1, [cos(angle), sin(angle)]);
                        r += dr;
                        i += di;
                    }
                    let [dr, di] = [re[place][l].value() - r, im[place][l].value() - i];
                    assert!(dr.abs() + di.abs() < off, "{length} {frequency}: {dr} {di}");
                }
            }
            fft.inverse(&mut re, &mut im);
            for k in 0..length {
                for l in 0..LANES {
                    let (r, i) = value(k, l);
                    let n = length as f64;
                    let [dr, di] = [re[k][l].value() / n - r, im[k][l].value() / n - i];
                    assert!(dr.abs() + di.abs() < off, "{length} {k}: {dr} {di}");
                }
            }
        }
    }

    #[test]
    fn transform_is_the_sum_that_defines_it() {
        is_the_sum_that_defines_it::<f64>(1e-14);
        is_the_sum_that_defines_it::<f32>(2e-6);
    }
}
