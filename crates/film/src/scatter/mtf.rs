//! Modulation transfer functions of films.

use super::spread::PointSpread;
use std::f64::consts::{LN_10, PI, SQRT_2};

/// A modulation transfer function: the fraction of contrast that a film keeps, over spatial frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Mtf {
    spread: PointSpread,
}

/// An error in the data of a modulation transfer function.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MtfError {
    /// A value is out of range.
    #[error("{what} {value} is out of range: {range}")]
    OutOfRange {
        /// Name of the value.
        what: &'static str,
        /// Value that was given.
        value: f64,
        /// Range of the value.
        range: &'static str,
    },
    /// There are fewer than two points.
    #[error("a modulation transfer function needs at least two points above 0 cycles/mm, not {0}")]
    TooFew(usize),
    /// Frequencies do not rise.
    #[error("frequencies must increase from point to point; {1} cycles/mm comes after {0}")]
    NotRising(f64, f64),
}

fn in_range(what: &'static str, value: f64, low: f64, high: f64, range: &'static str) -> Result<(), MtfError> {
    if value >= low && value <= high { Ok(()) } else { Err(MtfError::OutOfRange { what, value, range }) }
}

impl Mtf {
    /// Builds H. Frieser's one-constant model. It spreads a line of light as 10^(-2 |x| / k), so that
    /// M(f) = 1 / (1 + (pi k f / ln 10)^2).
    ///
    /// `k_mm` is k, the full width over which the spread falls to a tenth of its peak, 0.0001 to 1 mm; films have 0.005 to 0.04.
    /// Source: H. Frieser, "Spread function and contrast transfer function of photographic layers", Photographic Science and
    /// Engineering 4, 1960, 324.
    ///
    /// # Errors
    /// [`MtfError::OutOfRange`] if `k_mm` is out of range.
    pub fn frieser(k_mm: f64) -> Result<Self, MtfError> {
        in_range("Frieser's constant", k_mm, 1e-4, 1.0, "0.0001 to 1 mm")?;
        Ok(Self { spread: PointSpread::bessel(k_mm / (2.0 * LN_10)) })
    }

    /// Fits a measured curve: spatial frequency (cycles/mm, 0 or more, ascending) and response (0 to 2; 1 is full contrast).
    ///
    /// The result is the closest sum of Gaussians of non-negative weights (least squares at the points). Its point spread is smooth and
    /// positive, unlike that of straight lines between measured points.
    /// Responses above 1 are caused by the developer (adjacency), not by light, and are taken as 1: see [`super::Modulation`].
    /// [`Mtf::deviation`] tells how well the fit matches.
    ///
    /// # Errors
    /// [`MtfError`].
    pub fn measured(points: &[[f64; 2]]) -> Result<Self, MtfError> {
        check(points)?;
        // exp(-(f / g)^2) is the response of a Gaussian of the deviation 1 / (sqrt(2) pi g).
        let term = |[g, weight]: [f64; 2]| [1.0 / (SQRT_2 * PI * g), weight];
        Ok(Self { spread: PointSpread::new(gaussians(points).into_iter().map(term).collect()) })
    }

    /// Builds the transfer function of a point spread.
    pub(super) fn of(spread: PointSpread) -> Self {
        Self { spread }
    }

    /// Returns the response at `frequency` cycles/mm: 1 at 0, decreasing from there.
    #[must_use]
    pub fn response(&self, frequency: f64) -> f64 {
        self.spread.response(frequency)
    }

    /// Point spread of the light.
    #[must_use]
    pub fn spread(&self) -> &PointSpread {
        &self.spread
    }

    /// Returns the largest difference from measured points, with values above 1 taken as 1.
    #[must_use]
    pub fn deviation(&self, points: &[[f64; 2]]) -> f64 {
        points.iter().map(|p| (self.response(p[0]) - p[1].min(1.0)).abs()).fold(0.0, f64::max)
    }
}

fn gaussian(frequency: f64, g: f64) -> f64 {
    spectra_core::math::exp(-(frequency / g) * (frequency / g))
}

pub(super) fn check(points: &[[f64; 2]]) -> Result<(), MtfError> {
    for point in points {
        in_range("frequency", point[0], 0.0, 1e5, "0 to 100 000 cycles/mm")?;
        in_range("response", point[1], 0.0, 2.0, "0 to 2")?;
    }
    if let Some(pair) = points.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
        return Err(MtfError::NotRising(pair[0][0], pair[1][0]));
    }
    let positive = points.iter().filter(|p| p[0] > 0.0).count();
    if positive < 2 { Err(MtfError::TooFew(positive)) } else { Ok(()) }
}

/// The widest Gaussian of a fit, cycles/mm: its deviation is 40 um. The emulsion does not scatter farther.
const WIDEST: f64 = 5.6;

/// Fits the points by a sum of Gaussians of fixed widths, with non-negative weights that sum to 1. Minimizes coordinate by coordinate
/// (problem: C. L. Lawson and R. J. Hanson, "Solving Least Squares Problems", 1974).
fn gaussians(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    const RUNGS: usize = 40;
    const ROUNDS: usize = 4000;
    // Weight of an error of the sum, relative to that of a point.
    const SUM: f64 = 30.0;
    let first = points.iter().map(|p| p[0]).find(|f| *f > 0.0).unwrap_or(1.0);
    let last = points.iter().map(|p| p[0]).fold(first, f64::max);
    let (low, high) = ((first.max(last / 300.0) * 0.7).max(WIDEST.min(last)), last * 6.0);
    let ladder: Vec<f64> =
        (0..RUNGS).map(|i| low * spectra_core::math::pow(high / low, i as f64 / (RUNGS - 1) as f64)).collect();
    let column =
        |g: &f64| -> Vec<f64> { points.iter().map(|p| gaussian(p[0], *g)).chain(std::iter::once(SUM)).collect() };
    let columns: Vec<Vec<f64>> = ladder.iter().map(column).collect();
    let mut weights = [0.0; RUNGS];
    let mut rest: Vec<f64> = points.iter().map(|p| p[1].min(1.0)).chain(std::iter::once(SUM)).collect();
    for _ in 0..ROUNDS {
        for (w, column) in weights.iter_mut().zip(&columns) {
            let square: f64 = column.iter().map(|c| c * c).sum();
            let slope: f64 = column.iter().zip(&rest).map(|(c, r)| c * r).sum();
            let next = (*w + slope / square).max(0.0);
            rest.iter_mut().zip(column).for_each(|(r, c)| *r -= (next - *w) * c);
            *w = next;
        }
    }
    let sum: f64 = weights.iter().sum();
    ladder.into_iter().zip(weights).filter(|(_, w)| *w > 0.0).map(|(g, w)| [g, w / sum]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friesers_curve_is_the_transform_of_his_line() {
        let k = 0.015;
        let mtf = Mtf::frieser(k).unwrap();
        for f in [5.0, 20.0, 49.0, 100.0] {
            let step = k / 20_000.0;
            let (mut sum, mut total) = (0.0, 0.0);
            for i in 0..200_000 {
                let x = (f64::from(i) + 0.5) * step;
                let line = spectra_core::math::pow(10.0, -2.0 * x / k);
                sum += line * spectra_core::math::cos(2.0 * PI * f * x);
                total += line;
            }
            assert!((mtf.response(f) - sum / total).abs() < 1e-6, "{f}");
        }
    }

    /// Points with the shape of a sheet's curve, without overshoot: a positive spread passes through them.
    #[test]
    fn measured_curves_go_through_their_points() {
        let points = [[5.0, 0.99], [10.0, 0.965], [20.0, 0.87], [40.0, 0.62], [60.0, 0.43], [100.0, 0.22]];
        let mtf = Mtf::measured(&points).unwrap();
        println!("deviation {:.5}", mtf.deviation(&points));
        assert!(mtf.deviation(&points) < 0.005, "{}", mtf.deviation(&points));
        assert!((mtf.response(0.0) - 1.0).abs() < 1e-12);
        // Adjacency: values above 1 are followed as 1, as far as a positive spread can.
        let edge = [[3.0, 1.04], [10.0, 1.1], [20.0, 1.05], [40.0, 0.8], [80.0, 0.4], [160.0, 0.15]];
        let mtf = Mtf::measured(&edge).unwrap();
        println!("with adjacency: deviation {:.5}", mtf.deviation(&edge));
        assert!(mtf.deviation(&edge) < 0.08);
        assert!((0..2000).all(|f| mtf.response(f64::from(f)) >= mtf.response(f64::from(f + 1))));
    }

    /// Frieser's curve is a mixture of Gaussians too, exp(-t) in t = 1/g^2.
    #[test]
    fn friesers_curve_is_fitted() {
        let truth = Mtf::frieser(0.0173).unwrap();
        let points: Vec<[f64; 2]> = (1..20).map(|i| f64::from(i) * 7.0).map(|f| [f, truth.response(f)]).collect();
        assert!(Mtf::measured(&points).unwrap().deviation(&points) < 5e-3);
    }

    #[test]
    fn bad_curves_are_named() {
        assert!(matches!(Mtf::measured(&[[1.0, 1.0]]), Err(MtfError::TooFew(1))));
        assert!(matches!(Mtf::measured(&[[2.0, 1.0], [2.0, 0.9]]), Err(MtfError::NotRising(..))));
        assert!(matches!(Mtf::measured(&[[2.0, 1.0], [f64::NAN, 0.9]]), Err(MtfError::OutOfRange { .. })));
        assert!(matches!(Mtf::frieser(0.0), Err(MtfError::OutOfRange { .. })));
    }
}
