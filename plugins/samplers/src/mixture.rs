//! Lines drawn as lines, and a continuum beside them.

use crate::Quantiles;
use spectra_core::batch::CONTINUUM;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::spectral::Line;
use spectra_core::stage::WavelengthDensity;

/// A way to draw from a continuum alone.
pub trait Continuum: Send + Sync {
    /// Draws one wavelength a number of `u` in [0, 1): writes it (nm), and multiplies the weight by one
    /// over the density (nm). All slices are of one length.
    fn draw(&self, u: &[f64], wavelength_nm: &mut [f64], weight: &mut [f64], isa: Isa);

    /// Density at a wavelength, 1/nm, of integral 1.
    fn density_per_nm(&self, wavelength_nm: f64) -> f64;
}

/// How the lines share their part of the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shares {
    /// In proportion to their weights. Where one channel sees, and the weights are power times its
    /// response, each sample of a line source is its exact exposure.
    Proportional,
    /// In proportion, rounded to a whole number of 64 strata (or of a greater power of 2, where there
    /// are many lines), one at least. As many stratified samples hold each line exactly as often as
    /// its probability says, so that the exposure of every channel is exact.
    WholeStrata,
}

/// Fewest and most strata that lines are rounded to; fewer samples than a pixel usually gets, and the
/// size of a block that Sobol points fill evenly.
const STRATA: [u32; 2] = [64, 4096];

/// The last number before 1: what is rescaled to [0, 1) may be rounded up to 1.
const BELOW_ONE: f64 = 1.0 - 0.5 * f64::EPSILON;

/// Numbers that go through small buffers at a time.
pub(crate) const CHUNK: usize = 256;

/// A density made of lines with probabilities and a continuum.
#[derive(Clone, Debug)]
pub struct Mixture<C = Quantiles> {
    /// Lines that can be drawn: (number in the source, wavelength nm, probability).
    lines: Vec<(u32, f64, f64)>,
    /// Upper ends of the lines' parts of [0, 1).
    upper: Vec<f64>,
    line_share: f64,
    continuum: Option<C>,
}

impl<C> Mixture<C> {
    /// A mixture of the source's `lines`, drawn by `weights` shared out as `shares` says, and a
    /// continuum; the lines together get `line_share` of the samples, rounded to whole strata. `None`
    /// where nothing can be drawn.
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

/// Share of all lines and the probability of each.
fn share_out(weights: &[f64], shares: Shares, line_share: f64, beside_continuum: bool) -> (f64, Vec<f64>) {
    if weights.is_empty() {
        return (0.0, Vec::new());
    }
    // A stratum for each line costs the continuum less than lines that are drawn now and then would: its error falls with
    // more than the number of strata, theirs does not.
    let of_lines = |strata: u32, least: u32| {
        let most = if beside_continuum { strata - 1 } else { strata };
        ((line_share * f64::from(strata)).round() as u32).max(least).min(most)
    };
    // Lines may take half of the strata for that.
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

/// Adams's method of apportionment: each gets one, and the next always goes to the one that has most
/// weight for each that it has.
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
        // What belongs to the continuum is drawn together, as vectors.
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

    /// By hand: seats of Adams's method for 10 : 5 : 1.
    #[test]
    fn apportionment_leaves_no_line_out() {
        assert_eq!(apportion(&[10.0, 5.0, 1.0], 8), [5, 2, 1]);
        assert_eq!(apportion(&[1.0, 1e-30], 64), [63, 1]);
        assert_eq!(apportion(&[3.0], 64), [64]);
    }

    /// Every line begins and ends at an edge of a stratum; too many lines for 64 get more strata.
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

    /// More lines than any strata can hold are drawn in proportion.
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
