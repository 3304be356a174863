//! Gaussian terms for a whole chain of light, filters, surfaces and film.
//!
//! Each factor is a signed sum of Gaussian terms, known exactly or fitted. The product of the factors is again such a sum, with one term
//! for each choice of one term from every factor, and its integral is exact. Following one term of every factor estimates that integral
//! without any wavelength. This module computes the scatter of such an estimate and measures it.

mod figure;

pub use figure::figure;

use serde::Serialize;
use spectra_core::Isa;
use spectra_core::numbers::Numbers;
use spectra_core::spectral::Grid;
use spectra_spectrum::{AnySpectrum, GaussianMixture, OneTerm, SpectralFunction, fit_gaussians};

/// Largest number of terms of a product.
pub const MOST_TERMS: f64 = 1_000_000.0;
/// Numbers of samples at which the scatter is measured.
const SAMPLES: [usize; 6] = [4, 16, 64, 256, 1024, 4096];
/// Number of seeds for each number of samples.
const SEEDS: u64 = 200;
/// Widest panel of a quadrature, nm.
const PANEL_NM: f64 = 0.5;

/// One factor of a chain as a sum of Gaussian terms.
#[derive(Clone, Debug, Serialize)]
pub struct Factor {
    /// Name of the factor.
    pub name: String,
    /// Kind of spectrum: `emission`, `transmittance`, `reflectance` or `sensitivity`.
    pub kind: &'static str,
    /// Number of terms.
    pub terms: usize,
    /// Whether the factor is defined by Gaussians, so that nothing was fitted.
    pub exact: bool,
    /// Relative L2 error of the fitted terms; 0 if exact.
    pub relative_l2: f64,
    /// Relative error of the integral of the terms; 0 if exact.
    pub integral_error: f64,
    /// Cancellation of the terms: the sum of their absolute integrals, divided by the absolute value of the sum of their
    /// integrals.
    pub kappa: f64,
    /// The Gaussian terms of the factor.
    #[serde(skip)]
    pub mixture: GaussianMixture,
    /// The spectrum itself.
    #[serde(skip)]
    pub shape: SpectralFunction,
}

/// Relative errors of estimates of [`Chain::integral`] with one number of samples.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Scatter {
    /// Number of samples of one estimate.
    pub samples: usize,
    /// Error with one term of every factor: root mean square over the seeds, as measured.
    pub one_term_measured: f64,
    /// Error with one term of every factor, as computed from all possible choices of terms.
    pub one_term: f64,
    /// Error with wavelengths drawn uniformly over the band, as computed.
    pub even: f64,
    /// Error with wavelengths drawn in proportion to the first factor, as computed.
    pub first_factor: f64,
}

/// A product of factors, each a sum of Gaussian terms.
#[derive(Clone, Debug, Serialize)]
pub struct Chain {
    /// Factors in their order.
    pub factors: Vec<Factor>,
    /// First and last wavelength of the band, nm.
    pub band_nm: [f64; 2],
    /// Number of terms of the product.
    pub terms: usize,
    /// Exact integral of the product of the factors over the band: the sum of the integrals of the product's terms.
    pub integral: f64,
    /// Integral of the same product by quadrature over the band.
    pub quadrature: f64,
    /// Absolute value of `integral` - `quadrature`, divided by the sum of the absolute integrals of all terms.
    pub difference: f64,
    /// Integral of the product of the spectra themselves, by quadrature.
    pub of_spectra: f64,
    /// Relative error due to the fits: `integral` / `of_spectra` - 1.
    pub fit_error: f64,
    /// Cancellation of the product: the sum of the absolute integrals of all its terms, divided by the absolute value of
    /// `integral`.
    pub kappa: f64,
    /// Mean of the estimates with one term of every factor, over all choices of terms; equal to the integral.
    pub one_term_mean: f64,
    /// Relative standard deviation of one such estimate, computed from all choices of terms.
    pub one_term_deviation: f64,
    /// Number of estimates from which each error is measured.
    pub seeds: u64,
    /// Errors for several numbers of samples.
    pub scatter: Vec<Scatter>,
    /// The product as a sum of terms.
    #[serde(skip)]
    pub product: GaussianMixture,
}

/// Why a chain could not be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ChainError {
    /// A factor emits spectral lines.
    #[error("`{0}` has spectral lines, which are not Gaussian terms")]
    Lines(String),
    /// Gaussian terms cannot be fitted to a factor.
    #[error("`{name}` cannot be fitted: {reason}")]
    Fit {
        /// Name of the factor.
        name: String,
        /// Reason why the fit failed.
        reason: String,
    },
    /// The chain has two lights, or two detectors.
    #[error("`{first}` and `{second}` are both of kind {kind}: a chain has at most one light and one detector")]
    Twice {
        /// Name of the first one.
        first: String,
        /// Name of the second one.
        second: String,
        /// Kind of both.
        kind: &'static str,
    },
    /// The product has too many terms.
    #[error("the product has {terms} terms, at most {MOST_TERMS} are supported")]
    TooMany {
        /// Number of terms of the product.
        terms: f64,
    },
    /// No light is left on the band.
    #[error("no light passes all factors within the band")]
    Dark,
}

impl Chain {
    /// Builds the product of `factors` (name and spectrum) over the band of `grid`. A factor that is not defined by Gaussians is
    /// fitted by `terms` Gaussians on that grid.
    ///
    /// # Errors
    /// [`ChainError`]. At most [`MOST_TERMS`] terms, one light and one detector are allowed.
    pub fn new(factors: &[(String, AnySpectrum)], terms: usize, grid: &Grid, isa: Isa) -> Result<Self, ChainError> {
        for (i, (second, found)) in factors.iter().enumerate() {
            let is_end = matches!(found, AnySpectrum::Emission(_) | AnySpectrum::Sensitivity(_));
            let same = |(_, other): &&(String, AnySpectrum)| other.kind() == found.kind();
            if let Some((first, _)) = factors[..i].iter().find(same).filter(|_| is_end) {
                let (first, second) = (first.clone(), second.clone());
                return Err(ChainError::Twice { first, second, kind: found.kind().word() });
            }
        }
        // Check the number of terms before anything is fitted.
        let terms_of = |found: &AnySpectrum| {
            shape_of(found).and_then(SpectralFunction::as_mixture).map_or(terms, |m| m.terms().len())
        };
        let count = factors.iter().map(|(_, found)| terms_of(found) as f64).product::<f64>();
        if count > MOST_TERMS {
            return Err(ChainError::TooMany { terms: count });
        }
        let factors: Vec<Factor> =
            factors.iter().map(|(name, found)| factor(name, found, terms, grid)).collect::<Result<_, _>>()?;
        let [min_nm, max_nm] = [grid.start_nm, grid.end_nm()];
        let one_term = OneTerm::new(factors.iter().map(|f| f.mixture.clone()).collect(), min_nm, max_nm);
        let one_term = one_term.ok_or(ChainError::Dark)?;
        let mut product = factors[0].mixture.clone();
        for factor in &factors[1..] {
            product = product.times(&factor.mixture);
        }
        let integral = product.band_integral(min_nm, max_nm);
        let sizes: f64 = product.terms().iter().map(|t| t.band_integral(min_nm, max_nm).abs()).sum();
        let together = |shape: &dyn Fn(&Factor) -> SpectralFunction| {
            let all = factors[1..].iter().fold(shape(&factors[0]), |all, f| all.times(&shape(f)));
            (all.integral(min_nm, max_nm, PANEL_NM), all)
        };
        let (quadrature, of_terms) = together(&|f| SpectralFunction::mixture(f.mixture.clone()));
        let (of_spectra, _) = together(&|f| f.shape.clone());
        if !(of_spectra > 0.0 && integral.is_finite() && integral != 0.0) {
            return Err(ChainError::Dark);
        }
        let (mean, deviation) = one_term.moments();
        let relative = deviation / integral.abs();
        // Use the product of terms, so that all methods estimate the same integral.
        let wavelengths = |density: &SpectralFunction| {
            let all = density.integral(min_nm, max_nm, PANEL_NM);
            let second = of_terms.times(&of_terms).over(density).integral(min_nm, max_nm, PANEL_NM) * all;
            (second / (integral * integral) - 1.0).max(0.0).sqrt()
        };
        let even = SpectralFunction::rectangle(min_nm, max_nm).map_or(f64::NAN, |shape| wavelengths(&shape));
        let first = wavelengths(&factors[0].shape);
        let scatter = SAMPLES
            .into_iter()
            .map(|samples| {
                let root = (samples as f64).sqrt();
                let measured = measured(&one_term, integral, samples, isa);
                Scatter {
                    samples,
                    one_term_measured: measured,
                    one_term: relative / root,
                    even: even / root,
                    first_factor: first / root,
                }
            })
            .collect();
        Ok(Self {
            band_nm: [min_nm, max_nm],
            terms: product.terms().len(),
            integral,
            quadrature,
            difference: (integral - quadrature).abs() / sizes,
            of_spectra,
            fit_error: integral / of_spectra - 1.0,
            kappa: sizes / integral.abs(),
            one_term_mean: mean,
            one_term_deviation: relative,
            seeds: SEEDS,
            scatter,
            product,
            factors,
        })
    }

    /// Returns the errors for each number of samples as CSV.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut out = "samples,one_term_measured,one_term,even_wavelengths,wavelengths_by_first_factor\n".to_owned();
        for s in &self.scatter {
            let Scatter { samples, one_term_measured, one_term, even, first_factor } = s;
            out.push_str(&format!("{samples},{one_term_measured:e},{one_term:e},{even:e},{first_factor:e}\n"));
        }
        out
    }
}

fn factor(name: &str, found: &AnySpectrum, terms: usize, grid: &Grid) -> Result<Factor, ChainError> {
    if matches!(found, AnySpectrum::Emission(light) if !light.lines().is_empty()) {
        return Err(ChainError::Lines(name.to_owned()));
    }
    let shape = shape_of(found).ok_or(ChainError::Dark)?;
    let band = (grid.start_nm, grid.end_nm());
    let (exact, mixture, relative_l2, integral_error) = match shape.as_mixture() {
        Some(mixture) => (true, mixture, 0.0, 0.0),
        None => {
            let fit = fit_gaussians(grid, &shape.on_grid(grid), terms)
                .map_err(|e| ChainError::Fit { name: name.to_owned(), reason: e.to_string() })?;
            (false, fit.mixture, fit.report.relative_l2, fit.report.integral)
        }
    };
    Ok(Factor {
        name: name.to_owned(),
        kind: found.kind().word(),
        terms: mixture.terms().len(),
        exact,
        relative_l2,
        integral_error,
        kappa: mixture.kappa(band.0, band.1),
        mixture,
        shape: shape.clone(),
    })
}

/// Returns the spectrum as a function of wavelength; `None` for light that consists of lines alone.
fn shape_of(found: &AnySpectrum) -> Option<&SpectralFunction> {
    match found {
        AnySpectrum::Emission(light) => light.continuum(),
        AnySpectrum::Transmittance(filter) => Some(filter.shape()),
        AnySpectrum::Reflectance(surface) => Some(surface.shape()),
        AnySpectrum::Sensitivity(detector) => Some(detector.shape()),
    }
}

/// Measures the relative root-mean-square error of one-term estimates over the seeds.
fn measured(one_term: &OneTerm, integral: f64, samples: usize, isa: Isa) -> f64 {
    let factors = one_term.numbers();
    let mut columns = vec![vec![0.0; samples]; factors];
    let mut choice = vec![0.0; factors];
    let mut squares = 0.0;
    for seed in 0..SEEDS {
        // Use a stream for each number of samples, so that none shares its numbers with another.
        let numbers = Numbers::random(seed + 1);
        for (dimension, column) in columns.iter_mut().enumerate() {
            numbers.fill(isa, samples as u64, 0, dimension as u32, column);
        }
        let mut sum = 0.0;
        for sample in 0..samples {
            choice.iter_mut().zip(&columns).for_each(|(u, column)| *u = column[sample]);
            sum += one_term.estimate(&choice);
        }
        let error = sum / (samples as f64 * integral) - 1.0;
        squares += error * error;
    }
    (squares / SEEDS as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_spectrum::{
        BAND, Transmittance, find_emission, find_reflectance, find_sensitivity, find_transmittance,
    };

    #[test]
    fn a_chain_of_measured_spectra_is_exact_and_scatters_as_computed() {
        let factors = [
            ("D65".to_owned(), AnySpectrum::Emission(find_emission("D65").expect("bundled"))),
            ("red".to_owned(), AnySpectrum::Reflectance(find_reflectance("colorchecker#red").expect("bundled"))),
            ("yellow".to_owned(), AnySpectrum::Transmittance(find_transmittance("wratten-12").expect("bundled"))),
            ("film".to_owned(), AnySpectrum::Sensitivity(find_sensitivity("ilford-ortho-plus").expect("bundled"))),
        ];
        let chain = Chain::new(&factors, 6, &BAND, Isa::Baseline).expect("a chain");
        assert_eq!(chain.terms, 6_usize.pow(4));
        assert!(chain.difference < 1e-12, "{:e}", chain.difference);
        assert!((chain.one_term_mean / chain.integral - 1.0).abs() < 1e-9 * chain.kappa);
        assert!(chain.kappa >= 1.0 && chain.one_term_deviation > 0.0);
        // Four thousand samples agree with the computed scatter; fewer miss rare choices.
        let last = chain.scatter.last().expect("errors");
        let ratio = last.one_term_measured / last.one_term;
        assert!((0.7..1.3).contains(&ratio), "{ratio}");
        assert!(chain.csv().lines().count() == 7);
    }

    #[test]
    fn what_is_no_chain_says_why() {
        let light = |name: &str| (name.to_owned(), AnySpectrum::Emission(find_emission(name).expect("a light")));
        let new = |factors: &[(String, AnySpectrum)], terms| {
            Chain::new(factors, terms, &BAND, Isa::Baseline).map(|c| c.terms)
        };
        assert!(matches!(new(&[light("mercury")], 4), Err(ChainError::Lines(_))));
        assert!(matches!(new(&[light("D65"), light("A")], 4), Err(ChainError::Twice { .. })));
        let narrow = Transmittance::gaussian(550.0, 20.0, 1.0).expect("a filter");
        let filter = ("narrow".to_owned(), AnySpectrum::Transmittance(narrow));
        assert_eq!(new(&[light("gaussian:500,30"), filter.clone()], 4), Ok(1));
        let yellow = find_transmittance("wratten-12").expect("bundled");
        let mut many = vec![light("D65")];
        many.extend((0..4).map(|i| (i.to_string(), AnySpectrum::Transmittance(yellow.clone()))));
        assert!(matches!(new(&many, 20), Err(ChainError::TooMany { .. })));
    }
}
