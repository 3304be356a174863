//! Sampling that follows one Gaussian term of the source: the sample carries the light of that term alone.
//!
//! A term is drawn in proportion to the absolute value of its integral over the band, and then a wavelength from the term. The
//! sample carries the light of the term, not that of the source. Its weight is the ratio of the term's emission to the source's,
//! so that multiplying the source's radiance by it gives the term's radiance. The residual of the fit, source minus terms, is
//! followed as one more term: a table of either sign. Without it, the estimate would be that of the fit, not of the scene.
//!
//! Only a term of the source is followed. Following one term of every factor (filters, glass, detector) and integrating their
//! product exactly needs no wavelength; but then there is no single index of refraction, and so no path through a lens. See
//! [`crate::OneTerm`].

use crate::truncated_gaussian::EDGE;
use crate::{Cells, Continuum};
use spectra_core::isa::Isa;
use spectra_core::params::Fault;
use spectra_core::spectral::Grid;
use spectra_spectrum::{GaussianMixture, TruncatedGaussian};

/// A term of the source that can be drawn.
#[derive(Clone, Debug)]
struct Term {
    sign: f64,
    probability: f64,
    /// Upper end of this term's interval of [0, 1).
    upper: f64,
    gaussian: TruncatedGaussian,
}

/// The Gaussian terms of a source and the residual of the fit.
#[derive(Clone, Debug)]
pub(crate) struct Followed {
    grid: Grid,
    /// Values of the source itself at the points of the grid.
    source: Vec<f64>,
    mixture: GaussianMixture,
    terms: Vec<Term>,
    /// Integral of the absolute values of all terms and of the residual; `rest` is that of the residual alone.
    all: f64,
    rest: f64,
    left_over: Cells,
}

/// Fraction of the source that is added everywhere to the density of the residual. It is needed because a fit that is exact at two points
/// of the grid is not exact between them.
const LEAST: f64 = 1e-3;

impl Followed {
    /// Prepares the terms of `mixture` on the band of `grid`, and the residual of `source`, given at the points of the grid. Fails if no
    /// term reaches the band.
    pub(crate) fn new(mixture: &GaussianMixture, grid: Grid, source: &[f64]) -> Result<Self, Fault> {
        let (min_nm, max_nm) = (grid.start_nm, grid.end_nm());
        let integrals: Vec<f64> = mixture.terms().iter().map(|t| t.band_integral(min_nm, max_nm).abs()).collect();
        let left: Vec<f64> =
            grid.wavelengths_nm().zip(source).map(|(w, s)| (s - mixture.at(w)).abs() + LEAST * s.abs()).collect();
        let rest = grid.integrate(&left);
        let all = rest + integrals.iter().sum::<f64>();
        let left_over = Cells::of(grid, &left).filter(|_| all.is_finite() && all > 0.0);
        let left_over = left_over.ok_or("no Gaussian term reaches the band")?;
        let mut upper = 0.0;
        let mut terms = Vec::new();
        for (term, integral) in mixture.terms().iter().zip(&integrals).filter(|(_, w)| **w > 0.0) {
            let probability = integral / all;
            upper += probability;
            let gaussian = TruncatedGaussian::new(term.center_nm(), term.sigma_nm(), min_nm, max_nm)
                .map_err(|e| format!("a Gaussian term cannot be drawn: {e}"))?;
            terms.push(Term { sign: term.sign(), probability, upper, gaussian });
        }
        Ok(Self { grid, source: source.to_vec(), mixture: mixture.clone(), terms, all, rest, left_over })
    }

    /// Returns whether the terms cancel so little at a wavelength that a sample has at most a hundred times its proper weight.
    pub(crate) fn can_follow(&self, wavelength_nm: f64) -> bool {
        let source = self.source_at(wavelength_nm);
        source == 0.0 || source.abs() > 0.01 * self.all * self.density_per_nm(wavelength_nm)
    }

    fn source_at(&self, wavelength_nm: f64) -> f64 {
        self.grid.interpolate(&self.source, wavelength_nm)
    }
}

impl Continuum for Followed {
    fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], weight: &mut [f64], _isa: Isa) {
        let share = self.rest / self.all;
        for ((u, nm), weight) in u.iter().zip(wavelength_nm).zip(weight) {
            // The residual's interval comes after those of the terms.
            let at = self.terms.partition_point(|t| t.upper <= *u);
            let emitted = match self.terms.get(at) {
                Some(term) => {
                    let part = (u - (term.upper - term.probability)) / term.probability;
                    *nm = term.gaussian.quantile(part.clamp(EDGE, 1.0 - EDGE));
                    // The term divided by its density and its probability is its sign times the integral of all.
                    term.sign * self.all
                }
                None => {
                    *nm = self.left_over.quantile(((u - (1.0 - share)) / share).clamp(0.0, 1.0 - EDGE));
                    let left = self.source_at(*nm) - self.mixture.at(*nm);
                    left / (share * self.left_over.density_per_nm(*nm))
                }
            };
            let source = self.source_at(*nm);
            *weight *= if source == 0.0 { 0.0 } else { emitted / source };
        }
    }

    fn density_per_nm(&self, wavelength_nm: f64) -> f64 {
        let terms = self.terms.iter().map(|t| t.probability * t.gaussian.density(wavelength_nm));
        self.rest / self.all * self.left_over.density_per_nm(wavelength_nm) + terms.sum::<f64>()
    }
}
