//! Signed sums of Gaussian terms.

use super::GaussianTerm;

/// A signed sum of Gaussian terms: closed under sum, product and scale, with exact integrals.
///
/// ```
/// use spectra_spectrum::{GaussianMixture, GaussianTerm};
/// let filter = GaussianMixture::new(vec![
///     GaussianTerm::new(1.0, 560.0, 300.0)?,
///     GaussianTerm::new(-0.6, 520.0, 25.0)?,
/// ]);
/// let two = filter.times(&filter);
/// assert!((two.at(510.0) - filter.at(510.0) * filter.at(510.0)).abs() < 1e-14);
/// assert_eq!(two.terms().len(), 4);
/// # Ok::<(), spectra_spectrum::SpectrumError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Default)]
pub struct GaussianMixture {
    terms: Vec<GaussianTerm>,
}

impl GaussianMixture {
    /// Creates the sum of `terms`; without any it is 0 everywhere.
    #[must_use]
    pub fn new(terms: Vec<GaussianTerm>) -> Self {
        Self { terms }
    }

    /// Terms of the sum, in order.
    #[must_use]
    pub fn terms(&self) -> &[GaussianTerm] {
        &self.terms
    }

    /// Returns the value at `wavelength_nm`.
    #[must_use]
    pub fn at(&self, wavelength_nm: f64) -> f64 {
        self.terms.iter().map(|t| t.at(wavelength_nm)).sum()
    }

    /// Returns the exact integral from `min_nm` to `max_nm`.
    #[must_use]
    pub fn band_integral(&self, min_nm: f64, max_nm: f64) -> f64 {
        self.terms.iter().map(|t| t.band_integral(min_nm, max_nm)).sum()
    }

    /// Returns the sum of both mixtures, which has the terms of both.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self::new([self.terms.as_slice(), &other.terms].concat())
    }

    /// Returns the exact product of both mixtures: each term of `self` times each term of `other`, in that order.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        let products = self.terms.iter().flat_map(|a| other.terms.iter().map(|b| a.times(b)));
        Self::new(products.collect())
    }

    /// Multiplies the mixture by a number of either sign.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self::new(self.terms.iter().map(|t| t.scaled(factor)).collect())
    }

    /// Returns the mixture of the same terms with positive signs. At every wavelength it is at least the absolute value of this
    /// mixture.
    #[must_use]
    pub fn absolute(&self) -> Self {
        Self::new(self.terms.iter().map(GaussianTerm::absolute).collect())
    }

    /// Returns how much the terms cancel over a band: sum |w| / |sum w|, where w are the integrals of the terms over the band.
    /// The result is 1 for terms of one sign, infinite if the terms cancel completely, and NaN without terms.
    ///
    /// An estimate that draws one term in proportion to |w| and takes its integral has the relative standard deviation
    /// sqrt(kappa^2 - 1).
    #[must_use]
    pub fn kappa(&self, min_nm: f64, max_nm: f64) -> f64 {
        let weights = self.terms.iter().map(|t| t.band_integral(min_nm, max_nm));
        let (absolute, signed) = weights.fold((0.0, 0.0), |(a, s), w| (a + w.abs(), s + w));
        absolute / f64::abs(signed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell;

    fn mixture(terms: &[[f64; 3]]) -> GaussianMixture {
        let term = |[a, c, s]: &[f64; 3]| GaussianTerm::new(*a, *c, *s).expect("valid");
        GaussianMixture::new(terms.iter().map(term).collect())
    }

    /// Source, filters and detector of the term strategies: a product of n filters agrees with dense quadrature to 1e-12.
    #[test]
    fn products_of_mixtures_are_exact() {
        let source = mixture(&[[1.0, 560.0, 120.0], [-0.3, 600.0, 40.0]]);
        let filter = mixture(&[[1.0, 560.0, 300.0], [-0.6, 520.0, 25.0]]);
        let detector = mixture(&[[1.0, 445.0, 22.0], [1.0, 560.0, 45.0]]);
        let breaks: Vec<f64> = (0..=4000).map(|i| 380.0 + 0.1 * f64::from(i)).collect();
        let mut product = source.times(&detector);
        for n in 1..=4 {
            product = product.times(&filter);
            let value = |x: f64| source.at(x) * detector.at(x) * filter.at(x).powi(n);
            let want = cell::integral(value, &breaks);
            let got = product.band_integral(380.0, 780.0);
            assert!((got / want - 1.0).abs() < 1e-12, "{n}: {got} {want}");
            assert_eq!(product.terms().len(), 4 << n);
            assert!((product.at(520.0) / value(520.0) - 1.0).abs() < 1e-12);
        }
        let sum = source.plus(&detector.scaled(-2.0));
        assert!((sum.at(450.0) - (source.at(450.0) - 2.0 * detector.at(450.0))).abs() < 1e-15);
    }

    /// Second moment of following one term per ray, by enumeration. One term of each factor is drawn in proportion to the
    /// absolute value of its own band integral. The weight is the sign over the probability, and the product is integrated
    /// exactly. The expected values are the relative standard deviation of one sample after n equal filters, computed twice by
    /// other programs.
    #[test]
    fn following_one_term_has_the_exact_second_moment() {
        let source = mixture(&[[1.0, 560.0, 120.0]]);
        let filter = mixture(&[[1.0, 560.0, 300.0], [-0.6, 520.0, 25.0]]);
        let detector = mixture(&[[1.0, 445.0, 22.0], [1.0, 560.0, 45.0]]);
        /// Adds the first and second moments of all choices from `rest` on, after the product `so_far` was chosen.
        fn follow(so_far: &GaussianTerm, probability: f64, rest: &[&GaussianMixture], moments: &mut [f64; 2]) {
            let Some((factor, rest)) = rest.split_first() else {
                let value = so_far.band_integral(380.0, 780.0);
                moments[0] += value;
                moments[1] += value * value / probability;
                return;
            };
            let weights: Vec<f64> = factor.terms().iter().map(|t| t.band_integral(380.0, 780.0).abs()).collect();
            let all: f64 = weights.iter().sum();
            for (term, weight) in factor.terms().iter().zip(&weights) {
                follow(&so_far.times(term), probability * weight / all, rest, moments);
            }
        }
        for (n, want, digit) in
            [(1, 1.1825, 1e-4), (2, 2.361, 1e-3), (4, 9.669, 1e-3), (8, 223.3, 0.1), (12, 5687.0, 1.0)]
        {
            let mut factors = vec![&filter; n];
            factors.push(&detector);
            let mut moments = [0.0; 2];
            follow(&source.terms()[0], 1.0, &factors, &mut moments);
            let deviation = (moments[1] / (moments[0] * moments[0]) - 1.0).sqrt();
            println!("{n} filters: {deviation:.4}");
            assert!((deviation - want).abs() <= digit, "{n}: {deviation} {want}");
        }
    }

    /// kappa of one filter by hand: (sqrt(2 pi) (1 * 300 s + 0.6 * 25)) / (... - ...), s the share of the wide one.
    #[test]
    fn kappa_measures_cancellation() {
        let filter = mixture(&[[1.0, 560.0, 300.0], [-0.6, 520.0, 25.0]]);
        let wide = filter.terms()[0].band_integral(380.0, 780.0);
        let narrow = -filter.terms()[1].band_integral(380.0, 780.0);
        assert!((filter.kappa(380.0, 780.0) - (wide + narrow) / (wide - narrow)).abs() < 1e-14);
        assert_eq!(filter.absolute().kappa(380.0, 780.0), 1.0);
        assert!(mixture(&[]).kappa(380.0, 780.0).is_nan() && mixture(&[]).at(500.0) == 0.0);
        let nothing = mixture(&[[1.0, 500.0, 10.0], [-1.0, 500.0, 10.0]]);
        assert!(nothing.kappa(380.0, 780.0).is_infinite());
    }
}
