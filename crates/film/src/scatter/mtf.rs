//! Modulation transfer functions.

use std::f64::consts::{LN_10, PI};

/// How much contrast of a fine pattern a film keeps.
#[derive(Clone, Debug, PartialEq)]
pub struct Mtf {
    curve: Curve,
}

#[derive(Clone, Debug, PartialEq)]
enum Curve {
    /// Frieser's constant, mm.
    Frieser(f64),
    /// Cycles/mm and response.
    Measured(Vec<[f64; 2]>),
}

/// A curve that is none.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MtfError {
    /// A value out of range.
    #[error("{what} {value} is out of range: {range}")]
    OutOfRange {
        /// Which value.
        what: &'static str,
        /// The value.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// Fewer than two points.
    #[error("a modulation transfer function has at least two points, not {0}")]
    TooFew(usize),
    /// Frequencies that do not rise.
    #[error("frequencies rise from point to point; {1} cycles/mm comes after {0}")]
    NotRising(f64, f64),
}

fn in_range(what: &'static str, value: f64, low: f64, high: f64, range: &'static str) -> Result<(), MtfError> {
    if value >= low && value <= high { Ok(()) } else { Err(MtfError::OutOfRange { what, value, range }) }
}

impl Mtf {
    /// H. Frieser's one-constant model: a line of light is spread as 10^(-2 |x| / k), so that
    /// M(f) = 1 / (1 + (pi k f / ln 10)^2) (H. Frieser, "Spread function and contrast transfer function of photographic
    /// layers", Photographic Science and Engineering 4, 1960, 324). `k_mm` is the width in which the line falls to a tenth on
    /// both sides together, 0.0001 to 1 mm; films have 0.005 to 0.04.
    ///
    /// # Errors
    /// [`MtfError::OutOfRange`].
    pub fn frieser(k_mm: f64) -> Result<Self, MtfError> {
        in_range("Frieser's constant", k_mm, 1e-4, 1.0, "0.0001 to 1 mm")?;
        Ok(Self { curve: Curve::Frieser(k_mm) })
    }

    /// A measured curve: spatial frequency (cycles/mm, rising, from 0 on) and response (0 to 2; 1 is all contrast).
    ///
    /// Makers plot it over two logarithmic axes, so it is straight between points there. It is 1 at 0: below the first
    /// point the loss grows with the square of the frequency, as of every spread. Beyond the last it falls with the
    /// frequency's inverse square, as Frieser's does.
    ///
    /// # Errors
    /// [`MtfError`].
    pub fn measured(points: &[[f64; 2]]) -> Result<Self, MtfError> {
        for point in points {
            in_range("frequency", point[0], 0.0, 1e5, "0 to 100 000 cycles/mm")?;
            in_range("response", point[1], 0.0, 2.0, "0 to 2")?;
        }
        if let Some(pair) = points.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
            return Err(MtfError::NotRising(pair[0][0], pair[1][0]));
        }
        let positive: Vec<[f64; 2]> = points.iter().filter(|p| p[0] > 0.0).copied().collect();
        if positive.len() < 2 {
            return Err(MtfError::TooFew(positive.len()));
        }
        Ok(Self { curve: Curve::Measured(positive) })
    }

    /// The response at `frequency` cycles/mm.
    #[must_use]
    pub fn response(&self, frequency: f64) -> f64 {
        match &self.curve {
            Curve::Frieser(k_mm) => {
                let x = PI * k_mm * frequency / LN_10;
                1.0 / (1.0 + x * x)
            }
            Curve::Measured(points) => {
                let next = points.partition_point(|p| p[0] <= frequency);
                let first = points[0];
                if next == 0 {
                    let x = frequency / first[0];
                    return 1.0 + (first[1] - 1.0) * x * x;
                }
                let a = points[next - 1];
                let Some(b) = points.get(next) else {
                    let x = a[0] / frequency;
                    return a[1] * x * x;
                };
                let ln = spectra_core::math::log;
                let part = ln(frequency / a[0]) / ln(b[0] / a[0]);
                // A response of 0 has no logarithm.
                if a[1] > 0.0 && b[1] > 0.0 {
                    a[1] * spectra_core::math::pow(b[1] / a[1], part)
                } else {
                    a[1] + (b[1] - a[1]) * part
                }
            }
        }
    }

    /// Frieser's constant, mm, that fits this curve best: least squares of the response at its points, above 0.1 of the
    /// highest, values over 1 taken as 1.
    #[must_use]
    pub fn frieser_constant_mm(&self) -> f64 {
        let points = match &self.curve {
            Curve::Frieser(k_mm) => return *k_mm,
            Curve::Measured(points) => points,
        };
        let error = |log10_k: f64| -> f64 {
            let k = spectra_core::math::pow(10.0, log10_k);
            let model = Self { curve: Curve::Frieser(k) };
            let off = |p: &&[f64; 2]| model.response(p[0]) - p[1].min(1.0);
            points.iter().filter(|p| p[1] > 0.1).map(|p| off(&p) * off(&p)).sum()
        };
        // The error has one valley as a rule: find it coarsely, then close in by golden sections.
        let coarse = (0..161).map(|i| -4.0 + 0.025 * f64::from(i));
        let best = coarse.min_by(|a, b| error(*a).total_cmp(&error(*b))).unwrap_or(-2.0);
        let (mut low, mut high) = (best - 0.025, best + 0.025);
        let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
        for _ in 0..60 {
            let (a, b) = (high - golden * (high - low), low + golden * (high - low));
            if error(a) < error(b) {
                high = b;
            } else {
                low = a;
            }
        }
        spectra_core::math::pow(10.0, (low + high) / 2.0)
    }

    /// How far the light goes, mm: beyond, less than a millionth of it lies.
    pub(super) fn reach_mm(&self) -> f64 {
        // The spread of a point is K0(r / a) with a = k / (2 ln 10): 16 a hold all but 4e-7.
        16.0 * self.frieser_constant_mm() / (2.0 * LN_10)
    }
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

    #[test]
    fn measured_curves_go_through_their_points() {
        let points = [[5.0, 1.0], [20.0, 0.9], [50.0, 0.5], [100.0, 0.2]];
        let mtf = Mtf::measured(&points).unwrap();
        points.iter().for_each(|p| assert!((mtf.response(p[0]) - p[1]).abs() < 1e-12));
        assert!((mtf.response(1e6_f64.sqrt()) - 0.002).abs() < 1e-12, "{}", mtf.response(1000.0));
        assert_eq!(mtf.response(0.0), 1.0);
        // Straight in logarithms: the geometric mean of frequencies has that of responses.
        assert!((mtf.response((20.0_f64 * 50.0).sqrt()) - (0.9_f64 * 0.5).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn friesers_constant_is_found_again() {
        let truth = Mtf::frieser(0.0173).unwrap();
        let points: Vec<[f64; 2]> = (1..20).map(|i| f64::from(i) * 7.0).map(|f| [f, truth.response(f)]).collect();
        assert!((Mtf::measured(&points).unwrap().frieser_constant_mm() / 0.0173 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn bad_curves_are_named() {
        assert!(matches!(Mtf::measured(&[[1.0, 1.0]]), Err(MtfError::TooFew(1))));
        assert!(matches!(Mtf::measured(&[[2.0, 1.0], [2.0, 0.9]]), Err(MtfError::NotRising(..))));
        assert!(matches!(Mtf::measured(&[[2.0, 1.0], [f64::NAN, 0.9]]), Err(MtfError::OutOfRange { .. })));
        assert!(matches!(Mtf::frieser(0.0), Err(MtfError::OutOfRange { .. })));
    }
}
