//! One Gaussian of either sign.

use crate::error::{SpectrumError, check};
use crate::normal::{Mass, SQRT_TAU};

/// Gaussian of either sign: sign times exp(log_amplitude - (x - center)^2 / (2 sigma^2)), x a wavelength in nm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussianTerm {
    negative: bool,
    log_amplitude: f64,
    center_nm: f64,
    sigma_nm: f64,
}

impl GaussianTerm {
    /// Creates a term of height `amplitude` (of either sign) at `center_nm`, with standard deviation `sigma_nm`.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] unless the amplitude is finite, the center is within 1e9 nm of 0, and sigma is from 1e-6
    /// to 1e9 nm.
    pub fn new(amplitude: f64, center_nm: f64, sigma_nm: f64) -> Result<Self, SpectrumError> {
        check("amplitude", "finite", amplitude, |_| true)?;
        check("center, nm", "within 1e9 of 0", center_nm, |c| c.abs() <= 1e9)?;
        check("standard deviation, nm", "between 1e-6 and 1e9", sigma_nm, |s| (1e-6..=1e9).contains(&s))?;
        Ok(Self { negative: amplitude < 0.0, log_amplitude: libm::log(amplitude.abs()), center_nm, sigma_nm })
    }

    /// Creates the term `sign` exp(-a x^2 + b x + c), x in nm.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] unless the sign is 1 or -1, a is positive and all are finite, and as [`GaussianTerm::new`].
    pub fn from_abc(sign: f64, [a, b, c]: [f64; 3]) -> Result<Self, SpectrumError> {
        check("sign", "1 or -1", sign, |s| s.abs() == 1.0)?;
        check("a of a Gaussian, nm^-2", "positive", a, |a| a > 0.0)?;
        check("b of a Gaussian, nm^-1", "finite", b, |_| true)?;
        check("c of a Gaussian", "finite", c, |_| true)?;
        let center_nm = 0.5 * b / a;
        Ok(Self { log_amplitude: c + 0.5 * b * center_nm, ..Self::new(sign, center_nm, (0.5 / a).sqrt())? })
    }

    /// Returns the coefficients a, b and c of exp(-a x^2 + b x + c), x in nm. For a narrow term, c does not keep the digits of
    /// the amplitude.
    #[must_use]
    pub fn abc(&self) -> [f64; 3] {
        let variance = self.sigma_nm * self.sigma_nm;
        let b = self.center_nm / variance;
        [0.5 / variance, b, self.log_amplitude - 0.5 * b * self.center_nm]
    }

    /// Sign of the term, 1 or -1.
    #[must_use]
    pub fn sign(&self) -> f64 {
        if self.negative { -1.0 } else { 1.0 }
    }

    /// Natural logarithm of the height without its sign; minus infinity for a term of height 0.
    #[must_use]
    pub fn log_amplitude(&self) -> f64 {
        self.log_amplitude
    }

    /// Wavelength of the peak, nm.
    #[must_use]
    pub fn center_nm(&self) -> f64 {
        self.center_nm
    }

    /// Standard deviation of the term, nm.
    #[must_use]
    pub fn sigma_nm(&self) -> f64 {
        self.sigma_nm
    }

    /// Height of the peak, with its sign; 0 or infinite if only its logarithm can be represented.
    #[must_use]
    pub fn peak(&self) -> f64 {
        self.sign() * libm::exp(self.log_amplitude)
    }

    /// Returns the value at `wavelength_nm`.
    #[must_use]
    pub fn at(&self, wavelength_nm: f64) -> f64 {
        let t = (wavelength_nm - self.center_nm) / self.sigma_nm;
        self.sign() * libm::exp(self.log_amplitude - 0.5 * t * t)
    }

    /// Returns the integral over all wavelengths, including negative ones. If the center lies at an end of a band, this is up to
    /// twice the integral over the band.
    #[must_use]
    pub fn line_integral(&self) -> f64 {
        SQRT_TAU * self.sigma_nm * self.peak()
    }

    /// Returns the integral from `min_nm` to `max_nm`, either of which may be infinite; 0 unless `min_nm` < `max_nm`.
    ///
    /// It uses erf and, in the tails, erfc; the relative error is below 1e-12.
    #[must_use]
    pub fn band_integral(&self, min_nm: f64, max_nm: f64) -> f64 {
        let mass = Mass::of_width(
            (min_nm - self.center_nm) / self.sigma_nm,
            (max_nm - self.center_nm) / self.sigma_nm,
            (max_nm - min_nm) / self.sigma_nm,
        );
        // In one exponent, because either factor alone may overflow or underflow.
        let exponent = self.log_amplitude - 0.5 * mass.nearest * mass.nearest;
        self.sign() * self.sigma_nm * mass.scaled * libm::exp(exponent)
    }

    /// Returns the exact product with another term, which is a term again.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        let (v, w) = (self.sigma_nm * self.sigma_nm, other.sigma_nm * other.sigma_nm);
        let apart = other.center_nm - self.center_nm;
        let share = v / (v + w);
        Self {
            negative: self.negative != other.negative,
            log_amplitude: self.log_amplitude + other.log_amplitude - 0.5 * apart * apart / (v + w),
            center_nm: self.center_nm + apart * share,
            sigma_nm: other.sigma_nm * share.sqrt(),
        }
    }

    /// Multiplies the term by a number of either sign; NaN counts as 0.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let factor = if factor.is_nan() { 0.0 } else { factor };
        Self {
            negative: self.negative != (factor < 0.0),
            log_amplitude: self.log_amplitude + libm::log(factor.abs()),
            ..*self
        }
    }

    /// Returns the term without its sign.
    #[must_use]
    pub fn absolute(&self) -> Self {
        Self { negative: false, ..*self }
    }

    /// Creates a term from the logarithm of its amplitude; the width must already be checked. Used by fits, whose amplitudes
    /// are computed.
    pub(super) fn of_log(negative: bool, log_amplitude: f64, center_nm: f64, sigma_nm: f64) -> Self {
        Self { negative, log_amplitude, center_nm, sigma_nm }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell;
    use spectra_core::numbers::{Dimension, Numbers};

    /// Adaptive quadrature: an interval is halved until two halves of the eight-point rule agree with the whole. The tolerance
    /// is what the roundoff of an exponent of 700 leaves, or an amount negligible against `all`.
    fn adaptive(f: &dyn Fn(f64) -> f64, a: f64, b: f64, all: f64, depth: u32) -> f64 {
        let middle = 0.5 * (a + b);
        let (whole, halves) = (cell::integral(f, &[a, b]), cell::integral(f, &[a, middle, b]));
        if depth == 0 || (whole - halves).abs() <= 2e-13 * halves.abs() + 1e-16 * all.abs() {
            halves
        } else {
            adaptive(f, a, middle, all, depth - 1) + adaptive(f, middle, b, all, depth - 1)
        }
    }

    /// Integral of the term from `a` to `b`, with breaks at the term's own structure so that no narrow line is missed.
    fn quadrature(term: &GaussianTerm, a: f64, b: f64) -> f64 {
        let mut breaks = vec![a, b];
        for k in -40..=40 {
            breaks.push(term.center_nm() + f64::from(k) * term.sigma_nm());
        }
        // Toward the center from an end outside of it, the term may rise within a small part of its width.
        for k in 1..40 {
            let step = (b - a) * libm::exp2(-f64::from(k));
            breaks.extend([a + step, b - step]);
        }
        breaks.retain(|x| (a..=b).contains(x));
        breaks.sort_by(f64::total_cmp);
        let f = |x: f64| term.at(x);
        let all = cell::integral(f, &breaks);
        breaks.windows(2).map(|w| adaptive(&f, w[0], w[1], all, 12)).sum()
    }

    /// Reproducible numbers in [0, 1).
    fn random(count: usize, seed: u64) -> Vec<f64> {
        let mut u = vec![0.0; count];
        Numbers::random(seed).fill(spectra_core::Isa::Baseline, 0, 0, Dimension::Wavelength as u32, &mut u);
        u
    }

    /// Random centers in and far outside of the band, widths from 0.01 to 10 000 nm, random bands: 1e-12 relative.
    #[test]
    fn band_integral_is_that_of_adaptive_quadrature() {
        let mut tails = 0;
        let mut worst = 0.0_f64;
        for u in random(12_000, 3).chunks(4) {
            let sigma = libm::exp10(-2.0 + 6.0 * u[1]);
            let min = 350.0 + 300.0 * u[2];
            let max = min + 1.0 + 179.0 * u[3];
            // Up to 37 sigma beyond the band: about as far as f64 can hold the integral.
            let center = min - 37.0 * sigma + (max - min + 74.0 * sigma) * u[0];
            let term = GaussianTerm::new(1.0, center, sigma).expect("valid");
            let (got, want) = (term.band_integral(min, max), quadrature(&term, min, max));
            let off = (got / want - 1.0).abs();
            assert!(off < 1e-12, "{center} {sigma} on {min}-{max}: {got:e} {want:e}, {off:e}");
            worst = worst.max(off);
            tails += usize::from(center < min - 5.0 * sigma || center > max + 5.0 * sigma);
        }
        println!("worst of 3000: {worst:e}; {tails} in the tails");
        assert!(tails > 1000, "{tails}");
    }

    /// The product's values and integral, against dense quadrature of the two factors' product: 1e-12 relative.
    #[test]
    fn product_of_terms_is_exact() {
        let mut worst = 0.0_f64;
        for u in random(6000, 5).chunks(6) {
            let sign = |u: f64| if u < 0.5 { -1.0 } else { 1.0 };
            let width = |u: f64| libm::exp10(-0.5 + 3.0 * u);
            let a = GaussianTerm::new(sign(u[4]) * (0.1 + u[4]), 350.0 + 480.0 * u[0], width(u[1])).expect("valid");
            // Within a few widths of each other: further apart the product is too small for any quadrature.
            let apart = 6.0 * (u[2] - 0.5) * (a.sigma_nm() + width(u[3]));
            let b = GaussianTerm::new(sign(u[5]) * 3.0, a.center_nm() + apart, width(u[3])).expect("valid");
            let product = a.times(&b);
            assert_eq!(product.sign(), a.sign() * b.sign());
            let (c, s) = (product.center_nm(), product.sigma_nm());
            let breaks: Vec<f64> = (-160..=160).map(|k| c + s * f64::from(k) / 16.0).collect();
            let want = cell::integral(|x| a.at(x) * b.at(x), &breaks);
            let got = product.band_integral(breaks[0], breaks[320]);
            let off = (got / want - 1.0).abs();
            assert!(off < 1e-12, "{a:?} {b:?}: {off:e}");
            worst = worst.max(off);
            for x in [c - 3.0 * s, c, c + 2.0 * s] {
                assert!((product.at(x) / (a.at(x) * b.at(x)) - 1.0).abs() < 1e-12, "{a:?} {b:?} at {x}");
            }
        }
        println!("worst of 1000: {worst:e}");
    }

    /// The integral over the whole line over-counts by a factor of up to 2 if a center lies at an end of the band.
    #[test]
    fn whole_line_counts_twice_at_the_end_of_a_band() {
        let term = GaussianTerm::new(-2.0, 380.0, 30.0).expect("valid");
        assert!((term.line_integral() / term.band_integral(380.0, 1e9) - 2.0).abs() < 1e-14);
        let all = term.band_integral(f64::NEG_INFINITY, f64::INFINITY);
        assert!((all / term.line_integral() - 1.0).abs() < 1e-15);
        assert_eq!(term.band_integral(500.0, 500.0), 0.0);
        assert_eq!(term.band_integral(500.0, 400.0), 0.0);
    }

    #[test]
    fn abc_is_a_view() {
        let term = GaussianTerm::new(-0.7, 550.0, 40.0).expect("valid");
        let [a, b, c] = term.abc();
        for x in [400.0, 550.0, 700.0] {
            let want = -libm::exp(-a * x * x + b * x + c);
            assert!((term.at(x) / want - 1.0).abs() < 1e-12);
        }
        let back = GaussianTerm::from_abc(-1.0, [a, b, c]).expect("valid");
        assert!((back.center_nm() - 550.0).abs() < 1e-10 && (back.sigma_nm() - 40.0).abs() < 1e-12);
        assert!((back.peak() + 0.7).abs() < 1e-12);
        // A line of 1 nm: c is near -151 250, and the term still keeps its height.
        let line = GaussianTerm::new(1.0, 550.0, 1.0).expect("valid");
        assert!((line.abc()[2] + 151_250.0).abs() < 1e-6 && line.at(550.0) == 1.0);
    }

    /// Height and distance whose factors alone exceed the range of f64, with a product that does not.
    #[test]
    fn products_do_not_underflow_on_the_way() {
        let high = GaussianTerm::from_abc(1.0, [0.5, 0.0, 900.0]).expect("valid");
        let low = GaussianTerm::from_abc(1.0, [0.5, 0.0, -890.0]).expect("valid");
        assert!(high.peak().is_infinite() && low.peak() == 0.0);
        let product = high.times(&low);
        assert!((product.peak() / libm::exp(10.0) - 1.0).abs() < 1e-12);
        // 44 sigma out, where erfc is 0: the integral is that of the height.
        let far = GaussianTerm::from_abc(1.0, [0.5, 0.0, 968.0]).expect("valid");
        assert!((far.band_integral(44.0, 45.0) * 44.0 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn scaling_and_zero() {
        let term = GaussianTerm::new(2.0, 550.0, 10.0).expect("valid");
        assert!((term.scaled(-3.0).peak() + 6.0).abs() < 1e-14);
        assert!((term.scaled(-3.0).absolute().peak() - 6.0).abs() < 1e-14);
        let zero = GaussianTerm::new(0.0, 550.0, 10.0).expect("valid");
        for none in [zero, term.scaled(0.0), term.scaled(f64::NAN), zero.times(&term)] {
            assert_eq!((none.peak(), none.at(550.0), none.band_integral(0.0, 1000.0)), (0.0, 0.0, 0.0));
        }
    }

    #[test]
    fn impossible_terms_are_refused() {
        let nan = f64::NAN;
        for (amplitude, center, sigma) in
            [(nan, 550.0, 1.0), (1.0, nan, 1.0), (1.0, 550.0, 0.0), (1.0, 550.0, nan), (1.0, 1e10, 1.0)]
        {
            assert!(GaussianTerm::new(amplitude, center, sigma).is_err());
        }
        assert!(GaussianTerm::from_abc(1.0, [0.0, 0.0, 0.0]).is_err());
        assert!(GaussianTerm::from_abc(0.5, [1.0, 0.0, 0.0]).is_err());
    }
}
