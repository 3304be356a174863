//! One Gaussian term followed through all factors of a spectral integral.

use super::{GaussianMixture, GaussianTerm};

/// Estimator of the integral of a product of signed Gaussian mixtures (a source, filters, a detector) over a band. It follows one
/// term of each factor.
///
/// One term of each factor is drawn in proportion to the absolute value of its own integral over the band. The product of the
/// drawn terms is one term; its exact integral is divided by the probability of the choices. The method needs no wavelength, so
/// it cannot trace a ray through a lens. Its scatter multiplies with every factor whose terms cancel: with many such factors
/// rare choices carry the whole integral, and the scatter that samples show is far too low.
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
    /// Terms of each factor, with the upper ends of their parts of [0, 1) and their probabilities.
    factors: Vec<Vec<(GaussianTerm, f64, f64)>>,
    min_nm: f64,
    max_nm: f64,
}

impl OneTerm {
    /// Creates the estimator for the product of `factors` from `min_nm` to `max_nm`. Returns `None` without factors, or if one
    /// of them has no term that reaches the band.
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

    /// Returns how many random numbers an estimate needs: one per factor.
    #[must_use]
    pub fn numbers(&self) -> usize {
        self.factors.len()
    }

    /// Returns one estimate of the integral from independent numbers in [0, 1), one per factor; missing numbers count as 0.
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

    /// Returns the number of possible choices: the product of the numbers of terms that reach the band.
    #[must_use]
    pub fn choices(&self) -> f64 {
        self.factors.iter().map(|factor| factor.len() as f64).product()
    }

    /// Returns the exact mean (the integral) and standard deviation of one estimate. It enumerates all choices, whose number is
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
