//! One Gaussian term of the source followed: the sample carries what that term alone emits.
//!
//! A term is drawn in proportion to the absolute value of its integral over the band, and the wavelength from it. The
//! sample is the term's own light, not the source's: its weight is what the term emits over what the source does, so
//! that the radiance which a renderer multiplies in becomes that of the term. What the fit leaves over, source less terms, is
//! followed as one more term, a table of either sign; without it the estimate would be that of the fit, not of the scene.
//!
//! Only the source's term is followed. To follow one of every factor (filters, glass, detector) and to
//! integrate their product exactly needs no wavelength; but a term has no single index of refraction, and so no path
//! through a lens. See [`crate::OneTerm`].

use crate::truncated_gaussian::EDGE;
use crate::{Cells, Continuum};
use spectra_core::isa::Isa;
use spectra_core::spectral::Grid;
use spectra_spectrum::{GaussianMixture, TruncatedGaussian};

/// A term that can be followed.
#[derive(Clone, Debug)]
struct Term {
    sign: f64,
    probability: f64,
    /// Upper end of its part of [0, 1).
    upper: f64,
    gaussian: TruncatedGaussian,
}

/// Terms of a source, and what they leave over.
#[derive(Clone, Debug)]
pub(crate) struct Followed {
    grid: Grid,
    /// The source itself, at the points of the grid.
    source: Vec<f64>,
    mixture: GaussianMixture,
    terms: Vec<Term>,
    /// Integral of all terms without their signs, and of what is left over.
    all: f64,
    rest: f64,
    left_over: Cells,
}

/// Part of the source that the density of what is left over has everywhere: between two points of the grid at which a
/// fit is exact it is not.
const LEAST: f64 = 1e-3;

impl Followed {
    /// The terms of `mixture` on the band of `grid`, beside what is left of `source`, given at its points.
    pub(crate) fn new(mixture: &GaussianMixture, grid: Grid, source: &[f64]) -> Result<Self, String> {
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

    /// Whether the terms do not cancel so far that a sample weighs more than a hundred times what it should.
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
            // What is left over lies behind the terms.
            let at = self.terms.partition_point(|t| t.upper <= *u);
            let emitted = match self.terms.get(at) {
                Some(term) => {
                    let part = (u - (term.upper - term.probability)) / term.probability;
                    *nm = term.gaussian.quantile(part.clamp(EDGE, 1.0 - EDGE));
                    // The term over its own density and probability: its sign, times the integral of all.
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
