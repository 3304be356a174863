//! The mixture of spectral lines and a continuum from which wavelengths are drawn.

use crate::Quantiles;
use spectra_core::batch::CONTINUUM;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::spectral::Line;
use spectra_core::stage::WavelengthDensity;

/// A continuous density of wavelengths, without spectral lines, from which wavelengths can be drawn.
pub trait Continuum: Send + Sync {
    /// Draws one wavelength for each number of `u` in [0, 1). Writes it to `wavelength_nm`, and multiplies the element of
    /// `weight` by the reciprocal of the density there (nm). All slices have the same length.
    fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], weight: &mut [f64], isa: Isa);

    /// Density at a wavelength, 1/nm; its integral is 1.
    fn density_per_nm(&self, wavelength_nm: f64) -> f64;
}

/// How the probabilities of the lines follow from their weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shares {
    /// Probabilities are proportional to the weights. With a single channel, and weights that are power times its response, each
    /// sample of a line source gives the exact exposure.
    Proportional,
    /// Probabilities are proportional to the weights, rounded to a whole number of at least one of 64 strata (or of a larger power of 2
    /// if there are many lines). With as many stratified samples as strata, each line is drawn exactly as often as its probability
    /// says, so the exposure of every channel is exact.
    WholeStrata,
}

/// Least and largest number of strata to which lines are rounded. The least is fewer samples than a pixel usually gets; the largest is the
/// size of a block that Sobol points fill evenly.
const STRATA: [u32; 2] = [64, 4096];

/// The largest number below 1; numbers rescaled to [0, 1) may otherwise be rounded up to 1.
const BELOW_ONE: f64 = 1.0 - 0.5 * f64::EPSILON;

/// Number of samples processed at a time in small buffers.
pub(crate) const CHUNK: usize = 256;

/// A density of wavelengths: lines with probabilities, and a continuum.
#[derive(Clone, Debug)]
pub struct Mixture<C = Quantiles> {
    /// Lines that can be drawn: (number in the source, wavelength in nm, probability).
    lines: Vec<(u32, f64, f64)>,
    /// Upper ends of the lines' intervals of [0, 1).
    upper: Vec<f64>,
    line_share: f64,
    continuum: Option<C>,
}

impl<C> Mixture<C> {
    /// Creates a mixture of the source's `lines` and a continuum. The probabilities of the lines follow from `weights` and
    /// `shares`. If there is a continuum, the lines together get the fraction `line_share` of the samples, rounded to whole
    /// strata. `None` if nothing can be drawn.
    #[must_use]
    pub fn new(lines: &[Line], weights: &[f64], shares: Shares, line_share: f64, continuum: Option<C>) -> Option<Self> {
        let seen: Vec<usize> = (0..lines.len().min(weights.len())).filter(|i| weights[*i] > 0.0).collect();
        let line_share = match (seen.is_empty(), &continuum) {
            (false, Some(_)) => line_share,
            (false, None) => 1.0,
            (true, Some(_)) => 0.0,
            (true, None) => return None,
        };
        let seen_weights: Vec<f64> = seen.iter().map(|i| weights[*i]).collect();
        let (line_share, probabilities) = share_out(&seen_weights, shares, line_share, continuum.is_some());
        let mut upper = Vec::with_capacity(seen.len());
        let mut part = 0.0;
        for probability in &probabilities {
            part += probability;
            upper.push(part);
        }
        if let Some(last) = upper.last_mut() {
            *last = line_share; // the sum may have been rounded below it
        }
        let kept = seen.iter().zip(&probabilities).map(|(i, p)| (*i as u32, lines[*i].wavelength_nm, *p));
        Some(Self { lines: kept.collect(), upper, line_share, continuum })
    }
}

/// Returns the probability of all lines together and that of each line.
fn share_out(weights: &[f64], shares: Shares, line_share: f64, beside_continuum: bool) -> (f64, Vec<f64>) {
    if weights.is_empty() {
        return (0.0, Vec::new());
    }
    // Each line gets at least one stratum. This costs the continuum less than lines that are drawn only now and then would: the error of
    // the continuum falls faster than the number of strata grows, that of the lines does not.
    let of_lines = |strata: u32, least: u32| {
        let most = if beside_continuum { strata - 1 } else { strata };
        ((line_share * f64::from(strata)).round() as u32).max(least).min(most)
    };
    // To that end, lines may take half of the strata.
    let enough = |strata: &u32| weights.len() as u32 <= if beside_continuum { strata / 2 } else { *strata };
    let fine = (0..).map(|k| STRATA[0] << k).take_while(|s| *s <= STRATA[1]).find(enough);
    match (shares, fine) {
        (Shares::WholeStrata, Some(strata)) => {
            let all = of_lines(strata, weights.len() as u32);
            let counts = apportion(weights, all);
            let share = f64::from(all) / f64::from(strata);
            (share, counts.iter().map(|c| f64::from(*c) / f64::from(strata)).collect())
        }
        _ => {
            let share = f64::from(of_lines(STRATA[0], 1)) / f64::from(STRATA[0]);
            let sum: f64 = weights.iter().sum();
            (share, weights.iter().map(|w| w / sum * share).collect())
        }
    }
}

/// Apportions `strata` to the weights by Adams's method: each gets one, and the next always goes to the one with the largest weight per
/// stratum.
fn apportion(weights: &[f64], strata: u32) -> Vec<u32> {
    let mut counts = vec![1; weights.len()];
    for _ in weights.len() as u32..strata {
        let per = |i: usize| weights[i] / f64::from(counts[i]);
        let next = (0..weights.len()).fold(0, |best, i| if per(i) > per(best) { i } else { best });
        counts[next] += 1;
    }
    counts
}

impl<C: Continuum> WavelengthDensity for Mixture<C> {
    fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], line: &mut [u32], weight: &mut [f64], isa: Isa) {
        if self.lines.is_empty() {
            if let Some(continuum) = &self.continuum {
                continuum.draw(u, wavelength_nm, weight, isa);
                line.fill(CONTINUUM);
            }
            return;
        }
        let rest = 1.0 - self.line_share;
        // Draws from the continuum are collected and made together, as vectors.
        let (mut at, mut numbers) = ([0_usize; CHUNK], [0.0; CHUNK]);
        let (mut nm, mut inverse) = ([0.0; CHUNK], [1.0; CHUNK]);
        for first in (0..u.len()).step_by(CHUNK) {
            let mut many = 0;
            for i in first..u.len().min(first + CHUNK) {
                if u[i] < self.line_share {
                    let k = self.upper.partition_point(|p| *p <= u[i]).min(self.lines.len() - 1);
                    let (number, line_nm, probability) = self.lines[k];
                    (wavelength_nm[i], line[i]) = (line_nm, number);
                    weight[i] /= probability;
                } else {
                    at[many] = i;
                    numbers[many] = ((u[i] - self.line_share) / rest).min(BELOW_ONE);
                    inverse[many] = 1.0;
                    many += 1;
                }
            }
            if let Some(continuum) = &self.continuum {
                continuum.draw(&numbers[..many], &mut nm[..many], &mut inverse[..many], isa);
            }
            for k in 0..many {
                (wavelength_nm[at[k]], line[at[k]]) = (nm[k], CONTINUUM);
                weight[at[k]] *= inverse[k] / rest;
            }
        }
    }

    fn density_per_nm(&self, wavelength_nm: f64) -> f64 {
        self.continuum.as_ref().map_or(0.0, |c| c.density_per_nm(wavelength_nm) * (1.0 - self.line_share))
    }

    fn line_probability(&self, line: usize) -> f64 {
        self.lines.iter().find(|l| l.0 as usize == line).map_or(0.0, |l| l.2)
    }
}

impl Continuum for Quantiles {
    fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], weight: &mut [f64], isa: Isa) {
        isa.run(DrawQuantiles { quantiles: self, u, wavelength_nm, weight });
    }

    fn density_per_nm(&self, wavelength_nm: f64) -> f64 {
        Quantiles::density_per_nm(self, wavelength_nm)
    }
}

struct DrawQuantiles<'a> {
    quantiles: &'a Quantiles,
    u: &'a [f64],
    wavelength_nm: &'a mut [f64],
    weight: &'a mut [f64],
}

impl Vectorized for DrawQuantiles<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        const CHUNK: usize = crate::quantiles::CHUNK;
        let columns = self.u.chunks(CHUNK).zip(self.wavelength_nm.chunks_mut(CHUNK)).zip(self.weight.chunks_mut(CHUNK));
        for ((u, wavelength_nm), weight) in columns {
            self.quantiles.draw_chunk(u, wavelength_nm, weight);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(count: usize) -> Vec<Line> {
        (0..count).map(|i| Line { wavelength_nm: 400.0 + i as f64, power: 1.0 }).collect()
    }

    /// Seats by Adams's method for 10 : 5 : 1, worked out by hand; no line is left out.
    #[test]
    fn apportionment_leaves_no_line_out() {
        assert_eq!(apportion(&[10.0, 5.0, 1.0], 8), [5, 2, 1]);
        assert_eq!(apportion(&[1.0, 1e-30], 64), [63, 1]);
        assert_eq!(apportion(&[3.0], 64), [64]);
    }

    /// Every line's interval begins and ends at the edge of a stratum. Lines that are too many for 64 strata get more.
    #[test]
    fn lines_fill_whole_strata() {
        for (count, share, strata) in [(3, 0.3, 64.0), (32, 0.5, 64.0), (33, 0.5, 128.0), (500, 1.0, 512.0)] {
            let continuum = (share < 1.0).then(uniform);
            let weights: Vec<f64> = (0..count).map(|i| 1.0 + (i % 7) as f64).collect();
            let m = Mixture::new(&lines(count), &weights, Shares::WholeStrata, share, continuum).unwrap();
            for upper in &m.upper {
                assert_eq!((upper * strata).fract(), 0.0, "{count}");
            }
            assert!((m.line_share - share).abs() <= 0.5 / strata);
            assert!((0..count).all(|i| m.line_probability(i) > 0.0));
        }
    }

    /// Lines that are too many for any number of strata get proportional probabilities.
    #[test]
    fn very_many_lines_are_proportional() {
        let m = Mixture::<Quantiles>::new(&lines(5000), &[2.0; 5000], Shares::WholeStrata, 1.0, None).unwrap();
        assert!((m.line_probability(4999) - 1.0 / 5000.0).abs() < 1e-15);
    }

    #[test]
    fn unseen_lines_are_not_drawn_and_nothing_is_no_mixture() {
        let m = Mixture::<Quantiles>::new(&lines(2), &[0.0, 1.0], Shares::Proportional, 0.5, None).unwrap();
        assert_eq!((m.line_probability(0), m.line_probability(1), m.density_per_nm(500.0)), (0.0, 1.0, 0.0));
        assert!(Mixture::<Quantiles>::new(&lines(2), &[0.0; 2], Shares::Proportional, 0.5, None).is_none());
    }

    fn uniform() -> Quantiles {
        let grid = spectra_core::spectral::BAND;
        Quantiles::of(grid, &vec![1.0; grid.count]).expect("light")
    }
}
