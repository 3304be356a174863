//! One Gaussian term followed through all factors of a spectral integral.

use super::{GaussianMixture, GaussianTerm};

/// An integral over a band of a product of signed Gaussian mixtures (a source, filters, a detector), estimated by
/// following one term of each factor.
///
/// Of each factor a term is drawn in proportion to the absolute value of its own integral over the band; the product of the drawn
/// terms is one term, integrated exactly, over the probability of the choices. It needs no wavelength, so it
/// passes no lens, and its scatter multiplies with every factor whose terms cancel: with many of them rare
/// choices carry it all, and the scatter that samples show is far too low.
///
/// ```
/// use spectra_spectrum::{GaussianMixture, GaussianTerm, OneTerm};
/// let mixture = GaussianMixture::new(vec![GaussianTerm::new(2.0, 550.0, 30.0)?]);
/// let one_term = OneTerm::new(vec![mixture.clone()], 380.0, 780.0).unwrap();
/// assert_eq!(one_term.estimate(&[0.3]), mixture.band_integral(380.0, 780.0));
/// # Ok::<(), spectra_spectrum::SpectrumError>(())
/// ```
#[derive(Clone, Debug)]
pub struct OneTerm {
    /// Each factor's terms with the upper ends of their parts of [0, 1) and their probabilities.
    factors: Vec<Vec<(GaussianTerm, f64, f64)>>,
    min_nm: f64,
    max_nm: f64,
}

impl OneTerm {
    /// The product of `factors` from `min_nm` to `max_nm`; `None` without factors, or where one of them has no term
    /// that reaches the band.
    #[must_use]
    pub fn new(factors: Vec<GaussianMixture>, min_nm: f64, max_nm: f64) -> Option<Self> {
        let share = |factor: &GaussianMixture| {
            let weights: Vec<f64> = factor.terms().iter().map(|t| t.band_integral(min_nm, max_nm).abs()).collect();
            let sum: f64 = weights.iter().sum();
            if !(sum > 0.0 && sum.is_finite()) {
                return None;
            }
            let mut upper = 0.0;
            let terms = factor.terms().iter().zip(&weights).filter(|(_, w)| **w > 0.0).map(|(term, weight)| {
                upper += weight / sum;
                (*term, upper, weight / sum)
            });
            Some(terms.collect())
        };
        let factors = factors.iter().map(share).collect::<Option<Vec<_>>>()?;
        (!factors.is_empty()).then_some(Self { factors, min_nm, max_nm })
    }

    /// How many numbers an estimate takes: one a factor.
    #[must_use]
    pub fn numbers(&self) -> usize {
        self.factors.len()
    }

    /// One estimate of the integral, by independent numbers in [0, 1), one a factor; those that are missing count as 0.
    #[must_use]
    pub fn estimate(&self, u: &[f64]) -> f64 {
        let mut product: Option<GaussianTerm> = None;
        let mut probability = 1.0;
        for (i, factor) in self.factors.iter().enumerate() {
            let u = u.get(i).copied().unwrap_or(0.0);
            let (term, _, p) = &factor[factor.partition_point(|t| t.1 <= u).min(factor.len() - 1)];
            probability *= p;
            product = Some(product.map_or(*term, |so_far| so_far.times(term)));
        }
        product.map_or(0.0, |term| term.band_integral(self.min_nm, self.max_nm) / probability)
    }

    /// How many choices there are: the product of the numbers of terms that reach the band.
    #[must_use]
    pub fn choices(&self) -> f64 {
        self.factors.iter().map(|factor| factor.len() as f64).product()
    }

    /// Exact mean (the integral) and standard deviation of one estimate, by all choices that there are: their number is
    /// the product of the numbers of terms.
    #[must_use]
    pub fn moments(&self) -> (f64, f64) {
        let (mut first, mut second) = (0.0, 0.0);
        let mut choice = vec![0; self.factors.len()];
        loop {
            let mut terms = choice.iter().zip(&self.factors).map(|(k, factor)| factor[*k]);
            let chosen = terms
                .next()
                .map(|start| terms.fold((start.0, start.2), |(term, p), (next, _, q)| (term.times(&next), p * q)));
            if let Some((term, probability)) = chosen {
                let value = term.band_integral(self.min_nm, self.max_nm);
                first += value;
                second += value * value / probability;
            }
            let Some(at) = (0..choice.len()).find(|i| choice[*i] + 1 < self.factors[*i].len()) else { break };
            choice[at] += 1;
            choice[..at].fill(0);
        }
        (first, (second - first * first).max(0.0).sqrt())
    }
}
