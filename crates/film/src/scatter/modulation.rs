//! Separates a sheet's modulation transfer function into the effects of light and of development.
//!
//! Light gets two Gaussians, the developer a gain and a length of diffusion. Both are functions of the distance on the film, of which each
//! pixel gets the integral, so that no lattice shows around a lamp.

use super::mtf::{Mtf, MtfError, check};
use super::spread::PointSpread;
use crate::adjacency::Adjacency;
use spectra_core::math::{exp, log};

/// The two factors of a sheet's curve: the spread of light in the emulsion, and adjacency effects in the developer.
#[derive(Clone, Debug, PartialEq)]
pub struct Modulation {
    /// Response of the light: at most 1, decreasing with the frequency.
    pub mtf: Mtf,
    /// Adjacency effect of the developer; `None` if the curve needs none.
    pub adjacency: Option<Adjacency>,
}

/// Cost of a gain of 1, in units of the curve's error. Without it, a strong gain and a wide spread could cancel each other.
const DEARTH: f64 = 0.02;

/// Smallest gain; below it there is no adjacency effect.
const LEAST_GAIN: f64 = 0.01;

/// Search ranges: standard deviations of the two Gaussians for light, mm; diffusion lengths, mm; and the largest gain.
const DEVIATIONS: (f64, f64) = (0.0005, 0.04);
const LENGTHS: (f64, f64) = (0.008, 0.12);
const MOST_GAIN: f64 = 1.0;

impl Modulation {
    /// Separates a measured curve into its factors. Each point has a spatial frequency (cycles/mm, 0 or more, ascending) and a
    /// response (0 to 2; 1 is full contrast).
    ///
    /// The search finds gain and length of adjacency, and the two Gaussians of light, that fit the curve best. If the best fit has no
    /// adjacency, the light's part is [`Mtf::measured`].
    ///
    /// # Errors
    /// [`MtfError`].
    pub fn measured(points: &[[f64; 2]]) -> Result<Self, MtfError> {
        check(points)?;
        let search = Search { points };
        let place = search.run();
        let [first, second, length, gain] = place;
        if gain < LEAST_GAIN {
            return Ok(Self { mtf: Mtf::measured(points)?, adjacency: None });
        }
        let share = search.fitted(place).0;
        let terms = [[exp(first), share], [exp(second), 1.0 - share]];
        let light = PointSpread::new(terms.into_iter().filter(|t| t[1] > 0.0).collect());
        Ok(Self { mtf: Mtf::of(light), adjacency: Some(Adjacency { gain, length_mm: exp(length) }) })
    }

    /// Returns the response of both factors at `frequency` cycles/mm.
    #[must_use]
    pub fn response(&self, frequency: f64) -> f64 {
        self.mtf.response(frequency) * self.adjacency.map_or(1.0, |a| a.response(frequency))
    }
}

/// A point of the search: logarithms of two deviations and of the length (mm), and the gain.
type SearchPoint = [f64; 4];

struct Search<'a> {
    points: &'a [[f64; 2]],
}

impl Search<'_> {
    /// Cost to minimize: the root mean square error plus the cost of the gain.
    fn cost(&self, place: SearchPoint) -> f64 {
        let within = |v: f64, (low, high): (f64, f64)| (log(low)..=log(high)).contains(&v);
        let [first, second, length, gain] = place;
        let good = within(first, DEVIATIONS) && within(second, DEVIATIONS) && within(length, LENGTHS);
        if good && (0.0..=MOST_GAIN).contains(&gain) { self.fitted(place).1 + DEARTH * gain } else { f64::INFINITY }
    }

    /// Returns the best share of the first Gaussian, and the root mean square error with it.
    fn fitted(&self, [first, second, length, gain]: SearchPoint) -> (f64, f64) {
        let adjacency = Adjacency { gain, length_mm: exp(length) };
        let [first, second] = [exp(first), exp(second)];
        // Only the share is free: a linear least-squares fit.
        let parts = |[f, m]: &[f64; 2]| {
            let edges = adjacency.response(*f);
            let light = |sigma: f64| {
                let x = std::f64::consts::PI * sigma * f;
                edges * exp(-2.0 * x * x)
            };
            let (a, b) = (light(first), light(second));
            (a - b, m - b)
        };
        let (mut both, mut square) = (0.0, 0.0);
        for (difference, missing) in self.points.iter().map(parts) {
            both += difference * missing;
            square += difference * difference;
        }
        let share = if square > 0.0 { (both / square).clamp(0.0, 1.0) } else { 1.0 };
        let errors = self.points.iter().map(parts).map(|(d, m)| (m - share * d) * (m - share * d));
        (share, (errors.sum::<f64>() / self.points.len() as f64).sqrt())
    }

    /// Searches a coarse grid, then improves its best point by steps along the axes, which are halved when none helps (R. Hooke and T. A.
    /// Jeeves, "Direct search solution of numerical and statistical problems", J. ACM 8, 1961, 212).
    fn run(&self) -> SearchPoint {
        const RUNGS: usize = 8;
        let rung = |(low, high): (f64, f64), i: usize, n: usize| {
            log(low) + (log(high) - log(low)) * (i as f64 + 0.5) / n as f64
        };
        let mut best = (f64::INFINITY, [0.0; 4]);
        for length in 0..4 {
            for gain in [0.0, 0.1, 0.2, 0.4] {
                for second in 1..RUNGS {
                    for first in 0..second {
                        let deviation = |i: usize| rung(DEVIATIONS, i, RUNGS);
                        let place = [deviation(first), deviation(second), rung(LENGTHS, length, 4), gain];
                        let cost = self.cost(place);
                        if cost < best.0 {
                            best = (cost, place);
                        }
                    }
                }
            }
        }
        let mut step = [0.3, 0.3, 0.4, 0.1];
        while step[0] > 1e-3 {
            let before = best.0;
            for axis in 0..4 {
                for sign in [1.0, -1.0] {
                    let mut place = best.1;
                    place[axis] += sign * step[axis];
                    let cost = self.cost(place);
                    if cost < best.0 {
                        best = (cost, place);
                    }
                }
            }
            if best.0 > before - 1e-9 {
                step.iter_mut().for_each(|s| *s /= 2.0);
            }
        }
        best.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve made of known factors is separated into them.
    #[test]
    fn parts_that_made_a_curve_are_found() {
        let light = Mtf::measured(&[[10.0, 0.97], [20.0, 0.89], [40.0, 0.63], [80.0, 0.16]]).unwrap();
        let edges = Adjacency { gain: 0.22, length_mm: 0.045 };
        let points: Vec<[f64; 2]> = [2.5, 4.0, 6.0, 9.0, 13.0, 20.0, 30.0, 40.0, 55.0, 70.0, 90.0]
            .iter()
            .map(|f| [*f, light.response(*f) * edges.response(*f)])
            .collect();
        let found = Modulation::measured(&points).unwrap();
        let adjacency = found.adjacency.unwrap();
        println!("{adjacency:?}");
        assert!((adjacency.gain - 0.22).abs() < 0.04 && (adjacency.length_mm - 0.045).abs() < 0.015);
        for [f, m] in points {
            println!("{f}: {:.4} of {m:.4}", found.response(f));
            assert!((found.response(f) - m).abs() < 0.01, "{f}");
        }
    }

    /// A curve that never exceeds 1 has no adjacency.
    #[test]
    fn a_falling_curve_has_no_adjacency() {
        let points = [[5.0, 0.99], [10.0, 0.965], [20.0, 0.87], [40.0, 0.62], [60.0, 0.43], [100.0, 0.22]];
        let found = Modulation::measured(&points).unwrap();
        assert_eq!(found.adjacency, None);
        assert!(points.iter().all(|[f, m]| (found.response(*f) - m).abs() < 0.005));
    }
}
