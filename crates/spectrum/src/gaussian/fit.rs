//! Fit of a few Gaussians to a whole spectrum.

use spectra_core::numbers::{SplitMix64, mix64};
use spectra_core::spectral::Grid;

use super::projection::{CenterAndWidth, Problem, Projected};
use super::{GaussianMixture, GaussianTerm};
use crate::error::{SpectrumError, check};

/// Largest number of terms of a fit.
const MAX_TERMS: usize = 32;

/// Differences between a mixture and the spectrum that it approximates, on a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussianFitReport {
    /// Relative L2 error: the square root of the ratio of the sum of squared differences to the sum of squared values.
    pub relative_l2: f64,
    /// Largest absolute difference, over the largest absolute value.
    pub maximum: f64,
    /// Relative error of the integral: the integral of the mixture over the integral of the values, less 1. Values are linear
    /// between the points.
    pub integral: f64,
    /// Smallest value of the mixture on the grid, over the largest absolute value of the spectrum. If negative, it shows how far
    /// the mixture falls below 0.
    pub smallest: f64,
    /// Cancellation of the terms over the band; see [`GaussianMixture::kappa`].
    pub kappa: f64,
}

impl GaussianFitReport {
    /// Compares `mixture` with `values` on `grid`; the result is NaN if the values are all 0.
    #[must_use]
    pub fn of(mixture: &GaussianMixture, grid: &Grid, values: &[f64]) -> Self {
        let fitted: Vec<f64> = grid.wavelengths_nm().map(|w| mixture.at(w)).collect();
        let peak = values.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
        let off: Vec<f64> = fitted.iter().zip(values).map(|(f, v)| (f - v) / peak).collect();
        let squares: f64 = off.iter().map(|d| d * d).sum();
        let norm: f64 = values.iter().map(|v| (v / peak) * (v / peak)).sum();
        let (min, max) = (grid.start_nm, grid.end_nm());
        Self {
            relative_l2: (squares / norm).sqrt(),
            maximum: off.iter().fold(0.0, |a, d| f64::max(a, d.abs())),
            integral: mixture.band_integral(min, max) / grid.integrate(values) - 1.0,
            smallest: fitted.iter().fold(f64::INFINITY, |a, f| a.min(*f)) / peak,
            kappa: mixture.kappa(min, max),
        }
    }
}

/// Mixture that approximates a spectrum, and how well it does.
#[derive(Clone, Debug, PartialEq)]
pub struct GaussianFit {
    /// Fitted terms, sorted by center.
    pub mixture: GaussianMixture,
    /// Differences of the mixture from the spectrum.
    pub report: GaussianFitReport,
}

/// Fits a sum of `terms` signed Gaussian terms to `values` on `grid` by least squares.
///
/// Terms are added where they lower the error most, in several candidate sums at once, and all terms are refined after each
/// addition. Then the search restarts many times from the sums of least error, with terms removed, split or placed elsewhere. No
/// search of this kind is certain to find the sum of least error. It gives the same terms on every machine, in about a second for
/// eight terms on 401 points. Spectral lines are narrower than any term of a good small sum: remove them first.
///
/// # Errors
/// [`SpectrumError::OutOfRange`] unless there is one value for each point of the grid, all are finite and not all are 0. The
/// number of terms must be 1 to 32, and at most a third of the number of points.
pub fn fit_gaussians(grid: &Grid, values: &[f64], terms: usize) -> Result<GaussianFit, SpectrumError> {
    let points = grid.count as f64;
    check("number of values", "the number of points of the grid", values.len() as f64, |n| n == points)?;
    for v in values {
        check("value", "finite", *v, |_| true)?;
    }
    let peak = values.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    check("largest value", "other than 0", peak, |p| p > 0.0)?;
    check("number of terms", "between 1 and 32, and at most a third of the points", terms as f64, |n| {
        (1.0..=MAX_TERMS as f64).contains(&n) && 3.0 * n <= points
    })?;
    let x: Vec<f64> = grid.wavelengths_nm().collect();
    let y: Vec<f64> = values.iter().map(|v| v / peak).collect();
    let best = Search::new(grid, &x, &y).run(terms);
    let mut found: Vec<GaussianTerm> = best
        .places
        .iter()
        .zip(&best.heights)
        .map(|([center, log_sigma], height)| {
            let log = libm::log(height.abs()) + libm::log(peak);
            GaussianTerm::of_log(*height < 0.0, log, *center, libm::exp(*log_sigma))
        })
        .collect();
    found.sort_by(|a, b| a.center_nm().total_cmp(&b.center_nm()));
    let mixture = GaussianMixture::new(found);
    let report = GaussianFitReport::of(&mixture, grid, values);
    Ok(GaussianFit { mixture, report })
}

/// Candidate sums that are followed at once, additions tried on each, and refinement steps that each is given at first.
const WAYS: usize = 4;
const ADDITIONS: usize = 6;
const FIRST_STEPS: usize = 25;
/// Steps of the final refinement.
const LAST_STEPS: usize = 600;
/// Number of restarts for each term.
const RESTARTS_PER_TERM: u64 = 14;

struct Search<'a> {
    problem: Problem<'a>,
    /// Centers and widths at which a term may be added.
    candidates: Vec<CenterAndWidth>,
}

impl<'a> Search<'a> {
    fn new(grid: &Grid, x: &'a [f64], y: &'a [f64]) -> Self {
        let (start, end) = (grid.start_nm, grid.end_nm());
        let band = end - start;
        // A bell narrower than about two thirds of a step falls between the points; one as wide as ten bands is a parabola.
        let log_sigmas = [libm::log(0.7 * grid.step_nm), libm::log(10.0 * band)];
        let centers = [start - 2.0 * band, end + 2.0 * band];
        let mut candidates = Vec::new();
        let mut sigma = 2.0 * grid.step_nm;
        while sigma < 1.5 * band {
            // The centers of narrow candidates lie closer together, but never closer than 48 to the band.
            let step = (0.7 * sigma).max(band / 48.0);
            let mut center = start - 0.5 * sigma;
            while center <= end + 0.5 * sigma {
                candidates.push([center, libm::log(sigma)]);
                center += step;
            }
            sigma *= 1.8;
        }
        Self { problem: Problem { x, y, centers, log_sigmas }, candidates }
    }

    fn run(&self, terms: usize) -> Projected {
        let mut ways = vec![self.problem.project(&[])];
        for _ in 0..terms {
            let more = ways.iter().flat_map(|way| self.with_one_more(way)).collect();
            ways = best_of(more, WAYS);
        }
        let ways = ways.into_iter().map(|way| self.problem.refine(way, LAST_STEPS)).collect();
        let mut ways = best_of(ways, WAYS);
        for i in 0..RESTARTS_PER_TERM * terms as u64 {
            let from = &ways[(mix64(i ^ 0x5eed) % ways.len() as u64) as usize];
            let start = self.disturbed(from, i);
            let mut again = ways.clone();
            again.push(self.problem.refine(start, 8 * FIRST_STEPS));
            ways = best_of(again, WAYS);
        }
        let bottom = ways.into_iter().map(|way| self.problem.refine(way, LAST_STEPS)).collect();
        best_of(bottom, 1).swap_remove(0)
    }

    /// Extends the sum by one more term, at each of the places that help most.
    fn with_one_more(&self, way: &Projected) -> Vec<Projected> {
        let mut gains: Vec<(f64, CenterAndWidth)> =
            self.candidates.iter().map(|place| (self.problem.gain(way, *place), *place)).collect();
        gains.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut taken: Vec<CenterAndWidth> = Vec::new();
        for (_, place) in gains {
            let sigma = libm::exp(place[1]);
            let near = |t: &CenterAndWidth| (t[0] - place[0]).abs() < 0.8 * sigma && (t[1] - place[1]).abs() < 0.7;
            if !taken.iter().any(near) {
                taken.push(place);
            }
            if taken.len() == ADDITIONS {
                break;
            }
        }
        taken.iter().map(|place| self.problem.refine(self.problem.extend(way, &[*place]), FIRST_STEPS)).collect()
    }

    /// Makes a starting point near a good sum: one or two terms placed elsewhere, or all of them perturbed.
    fn disturbed(&self, from: &Projected, number: u64) -> Projected {
        let mut stream = SplitMix64::new(number);
        let mut random = || stream.unit();
        let mut places = from.places.clone();
        let count = places.len();
        if number.is_multiple_of(3) {
            for place in &mut places {
                place[0] += libm::exp(place[1]) * (random() - 0.5);
                place[1] += 0.8 * (random() - 0.5);
            }
            return self.problem.project(&places);
        }
        let out = if number % 3 == 1 { 1 } else { 2.min(count) };
        for _ in 0..out {
            let which = (random() * places.len() as f64) as usize;
            places.swap_remove(which.min(places.len() - 1));
        }
        for _ in 0..out {
            // Adds one of the better candidates, or splits an existing term in two.
            let rest = self.problem.project(&places);
            if !places.is_empty() && random() < 0.4 {
                let which = ((random() * places.len() as f64) as usize).min(places.len() - 1);
                let [center, log_sigma] = places[which];
                let half = 0.8 * libm::exp(log_sigma);
                places[which] = [center - half, log_sigma - 0.3];
                places.push([center + half, log_sigma - 0.3]);
            } else {
                let mut gains: Vec<(f64, CenterAndWidth)> =
                    self.candidates.iter().map(|place| (self.problem.gain(&rest, *place), *place)).collect();
                gains.sort_by(|a, b| b.0.total_cmp(&a.0));
                let skip = (random() * random() * 0.5 * gains.len() as f64) as usize;
                places.push(gains[skip].1);
            }
        }
        self.problem.project(&places)
    }
}

/// Returns the `count` sums of least error, without duplicates.
fn best_of(mut ways: Vec<Projected>, count: usize) -> Vec<Projected> {
    ways.sort_by(|a, b| a.sum.total_cmp(&b.sum));
    ways.dedup_by(|a, b| (a.sum - b.sum).abs() <= 1e-4 * b.sum);
    ways.truncate(count);
    ways
}

#[cfg(test)]
mod tests;
