//! The strategy `gaussian-terms`: the density is a few signed Gaussian terms, fitted to the source.
//!
//! There are three ways to draw from the terms. Collapsed: the sum of their absolute values is one density, and the weight of a
//! sample is one over it. Term, then wavelength: a term is drawn in proportion to the absolute value of its integral over the band,
//! then a wavelength from the term, and the sample keeps the term's sign. At a given wavelength the mean of the weights is the
//! same, but where terms cancel the weights scatter about it, so this way is never better. One term: the term is followed, and the
//! sample is its light alone ([`crate::followed`]). The latter two exist to be measured.
//!
//! No way is biased by the residual of the fit: either the source itself is evaluated at the wavelength, or the residual is
//! followed, too.

use crate::followed::Followed;
use crate::recorded_spectrum::RecordedSpectrum;
use crate::truncated_gaussian::EDGE;
use crate::{Cells, Continuum, Floor};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::isa::Isa;
use spectra_core::params::{Fault, Faults, Params};
use spectra_core::registry::Context;
use spectra_core::spectral::SystemResponse;
use spectra_core::stage::{WavelengthDensity, WavelengthSampler};
use spectra_spectrum::{GaussianMixture, TruncatedGaussian, fit_gaussians};

/// The way in which a wavelength is drawn from signed terms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Follow {
    /// Draws the wavelength from the sum of the terms' absolute values.
    #[default]
    Collapsed,
    /// Draws a term, whose sign stays with the sample, and then a wavelength from that term.
    TermThenWavelength,
    /// Draws a term and a wavelength from it; the sample is the light of that term alone. The floor is ignored.
    OneTerm,
}

/// A few Gaussian terms, fitted to the source.
///
/// The source's continuum is fitted by signed Gaussians, and wavelengths are drawn from them. `follow` says how. No way
/// of drawing is biased by the residual of the fit: either the source itself is evaluated at the wavelength, or the
/// residual is followed, too. The ways differ in their noise.
///
/// `collapsed` draws from the sum of the terms' absolute values, and is the one to use. `term-then-wavelength` draws a
/// term, then a wavelength from it, and keeps the term's sign: where terms cancel, its weights scatter. With `one-term`
/// the sample is the light of its term alone; it exists to be measured, and ignores the floor.
///
/// # Example
/// ```yaml
/// {kind: gaussian-terms, terms: 8}
/// ```
/// ```yaml
/// {kind: gaussian-terms, terms: 4, follow: one-term}
/// ```
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct GaussianTermsParams {
    /// Number of terms that are fitted to the source's continuum, 1 to 32; 6 if left out.
    #[serde(default = "usual_terms")]
    #[schemars(range(min = 1, max = MOST_TERMS))]
    pub terms: u32,
    /// Way in which a wavelength is drawn from the terms: `collapsed` (the usual), `term-then-wavelength` or `one-term`.
    #[serde(default)]
    pub follow: Follow,
    /// Fraction of the samples that follow the summed response of all channels instead, 0 to below 1, so that every wavelength to which
    /// a channel is sensitive can be drawn; 1/16 if left out.
    #[serde(default)]
    pub floor: Floor,
}

/// Largest number of terms.
const MOST_TERMS: u32 = 32;

fn usual_terms() -> u32 {
    6
}

/// The strategy `gaussian-terms`: draws wavelengths from signed Gaussian terms.
#[derive(Clone, Debug)]
pub struct GaussianTerms {
    terms: Terms,
    follow: Follow,
    floor: Floor,
}

#[derive(Clone, Debug)]
enum Terms {
    Fitted(usize),
    Given(GaussianMixture),
}

impl GaussianTerms {
    /// Creates the strategy with `terms` Gaussian terms, which are fitted once the source is known. `follow` is the way to draw
    /// from the terms. `None` unless there are 1 to 32 terms.
    #[must_use]
    pub fn fitted(terms: usize, follow: Follow, floor: Floor) -> Option<Self> {
        (1..=MOST_TERMS as usize).contains(&terms).then_some(Self { terms: Terms::Fitted(terms), follow, floor })
    }

    /// Creates the strategy with the terms of `mixture` instead of fitted ones. `follow` is the way to draw from the terms.
    #[must_use]
    pub fn given(mixture: GaussianMixture, follow: Follow, floor: Floor) -> Self {
        Self { terms: Terms::Given(mixture), follow, floor }
    }
}

impl WavelengthSampler for GaussianTerms {
    fn prepare(&self, system: &SystemResponse) -> Result<Box<dyn WavelengthDensity>, Fault> {
        let seen = RecordedSpectrum::of(system)?;
        if !seen.draws_continuum() {
            return Ok(Box::new(seen.mixture::<Signed>(system, None)?));
        }
        let grid = system.grid;
        let fitted;
        let mixture = match &self.terms {
            Terms::Given(mixture) => mixture,
            Terms::Fitted(terms) => {
                // Without a continuum the terms are fitted to the response of the channels.
                let fit_to = if seen.has_continuum { &system.source.continuum } else { &seen.response };
                fitted = fit_gaussians(&grid, fit_to, *terms).map_err(|e| format!("no terms fit the source: {e}"))?;
                &fitted.mixture
            }
        };
        if self.follow == Follow::OneTerm && seen.has_continuum {
            let followed = Followed::new(mixture, grid, &system.source.continuum)?;
            if let Some(nm) = seen.wavelengths_nm(&grid).find(|w| !followed.can_follow(*w)) {
                return Err(Fault::new(format!(
                    "the terms cancel at {nm} nm, where a channel is sensitive: a sample of one term would have a hundred times \
                     its proper weight"
                ))
                .hint("use fewer or more terms, or `follow: collapsed`"));
            }
            return Ok(Box::new(seen.mixture(system, Some(followed))?));
        }
        let floor = self.floor.cells(grid, &seen).map(|cells| (self.floor.share(), cells));
        let signed = Signed::new(mixture, self.follow, floor, grid.start_nm, grid.end_nm())?;
        // A narrow negative term subtracts most at its center, so the centers are checked, too.
        let centers = mixture.terms().iter().map(|t| t.center_nm());
        let centers = centers.filter(|w| grid.interpolate(&seen.response, *w) > 0.0);
        if let Some(nm) = seen.wavelengths_nm(&grid).chain(centers).find(|w| !signed.can_draw(*w)) {
            return Err(Fault::new(format!(
                "the terms cancel, or are all far away, at {nm} nm, where a channel is sensitive"
            ))
            .hint("use more terms, a floor, or `follow: collapsed`"));
        }
        Ok(Box::new(seen.mixture(system, Some(signed))?))
    }
}

/// One signed term that can be drawn.
#[derive(Clone, Debug)]
struct Term {
    sign: f64,
    probability: f64,
    /// Upper end of this term's interval of [0, 1).
    upper: f64,
    gaussian: TruncatedGaussian,
}

/// A continuum of signed terms, with a floor whose interval of [0, 1) comes before theirs.
#[derive(Clone, Debug)]
struct Signed {
    floor: Option<(f64, Cells)>,
    terms: Vec<Term>,
    follow: Follow,
}

impl Signed {
    fn new(
        mixture: &GaussianMixture,
        follow: Follow,
        floor: Option<(f64, Cells)>,
        min_nm: f64,
        max_nm: f64,
    ) -> Result<Self, Fault> {
        let integrals: Vec<f64> = mixture.terms().iter().map(|t| t.band_integral(min_nm, max_nm)).collect();
        let sum: f64 = integrals.iter().map(|w| w.abs()).sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return Err(Fault::new("no Gaussian term reaches the band"));
        }
        let mut upper = floor.as_ref().map_or(0.0, |f| f.0);
        let rest = 1.0 - upper;
        let mut terms = Vec::new();
        for (term, integral) in mixture.terms().iter().zip(&integrals).filter(|(_, w)| **w != 0.0) {
            let probability = integral.abs() / sum * rest;
            upper += probability;
            let gaussian = TruncatedGaussian::new(term.center_nm(), term.sigma_nm(), min_nm, max_nm)
                .map_err(|e| format!("a Gaussian term cannot be drawn: {e}"))?;
            terms.push(Term { sign: term.sign(), probability, upper, gaussian });
        }
        if let Some(last) = terms.last_mut() {
            last.upper = 1.0; // the sum may have been rounded below it
        }
        Ok(Self { floor, terms, follow })
    }

    fn of_floor(&self, wavelength_nm: f64) -> f64 {
        self.floor.as_ref().map_or(0.0, |(share, cells)| share * cells.density_per_nm(wavelength_nm))
    }

    /// Returns the divisor that gives a sample its weight, apart from its sign; 1/nm.
    fn divisor(&self, wavelength_nm: f64) -> f64 {
        let term = |t: &Term| {
            let density = t.probability * t.gaussian.density(wavelength_nm);
            if self.follow == Follow::TermThenWavelength { t.sign * density } else { density }
        };
        self.of_floor(wavelength_nm) + self.terms.iter().map(term).sum::<f64>()
    }

    /// Returns whether weights stay in bounds at a wavelength: the density is not practically 0, and the signed sum is more than a
    /// hundredth of it.
    fn can_draw(&self, wavelength_nm: f64) -> bool {
        let density = self.density_per_nm(wavelength_nm);
        density > 1e-12 && self.divisor(wavelength_nm) > 0.01 * density
    }
}

impl Continuum for Signed {
    fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], weight: &mut [f64], _isa: Isa) {
        for ((u, nm), weight) in u.iter().zip(wavelength_nm).zip(weight) {
            let mut sign = 1.0;
            match &self.floor {
                Some((share, cells)) if u < share => *nm = cells.quantile(u / share),
                _ => {
                    let at = self.terms.partition_point(|t| t.upper <= *u).min(self.terms.len() - 1);
                    let term = &self.terms[at];
                    let part = (u - (term.upper - term.probability)) / term.probability;
                    *nm = term.gaussian.quantile(part.clamp(EDGE, 1.0 - EDGE));
                    if self.follow == Follow::TermThenWavelength {
                        sign = term.sign;
                    }
                }
            }
            let divisor = self.divisor(*nm);
            // Where terms cancel, no channel is sensitive: otherwise the strategy would have been refused.
            *weight *= if divisor == 0.0 { 0.0 } else { sign / divisor };
        }
    }

    fn density_per_nm(&self, wavelength_nm: f64) -> f64 {
        let terms = self.terms.iter().map(|t| t.probability * t.gaussian.density(wavelength_nm));
        self.of_floor(wavelength_nm) + terms.sum::<f64>()
    }
}

fn build(params: &Params, _context: &Context<'_>) -> Result<Box<dyn WavelengthSampler>, Faults> {
    let GaussianTermsParams { terms, follow, floor } = params.parse()?;
    let sampler = GaussianTerms::fitted(terms as usize, follow, floor).ok_or_else(|| params.fault_here("no terms"))?;
    Ok(Box::new(sampler))
}

spectra_core::register!(wavelengths "gaussian-terms": GaussianTermsParams, build);
