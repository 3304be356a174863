//! Sellmeier's formula from a table.

use super::{Fit, FitError, Sample, check};
use crate::formula::SELLMEIER_1;
use crate::formula::{Formula, NumberedFormula};
use spectra_numerics::linear;

/// Poles that fits start from, um^2: two in the ultraviolet, one in the infrared (those of a crown glass).
const START_POLES: [[f64; 3]; 3] = [[0.012, 0.0, 0.0], [0.010, 100.0, 0.0], [0.006, 0.02, 100.0]];
/// Largest number of steps of the search.
const STEPS: usize = 400;

/// Fits Sellmeier's formula with `terms` resonances (1 to 3), n^2 = 1 + sum of K L^2 / (L^2 - M), by least squares in n
/// (Levenberg and Marquardt). Strengths K and poles M are positive, and poles stay outside the range of the samples' wavelengths.
///
/// # Errors
/// Fewer than two samples for each resonance, an invalid wavelength or index, terms out of range.
pub fn sellmeier_least_squares(samples: &[Sample], terms: usize) -> Result<Fit, FitError> {
    if !(1..=3).contains(&terms) {
        return Err(FitError::Undetermined);
    }
    check(samples, 2 * terms)?;
    let um2: Vec<f64> = samples.iter().map(|s| s.wavelength_nm * s.wavelength_nm * 1e-6).collect();
    let shortest = um2.iter().copied().fold(f64::INFINITY, f64::min);
    let longest = um2.iter().copied().fold(0.0, f64::max);
    if shortest == longest {
        return Err(FitError::Undetermined);
    }
    let parameters = Parameters { ultraviolet: 0.98 * shortest, infrared: 1.02 * longest };
    let poles = &START_POLES[terms - 1][..terms];
    let poles: Vec<f64> =
        poles.iter().map(|&m| if m < 1.0 { m.min(0.5 * shortest) } else { m.max(4.0 * longest) }).collect();
    let strengths = start_strengths(&um2, samples, &poles);
    let mut u: Vec<f64> = (0..terms).flat_map(|k| [libm::log(strengths[k]), parameters.free(poles[k])]).collect();
    let residuals = |u: &[f64]| -> Vec<f64> {
        let c = parameters.coefficients(u, &poles);
        um2.iter().zip(samples).map(|(&x, s)| square(&c, x).max(0.0).sqrt() - s.n).collect()
    };
    let sum = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
    let mut current = residuals(&u);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let jacobian = jacobian(&u, &residuals);
        let Some(step) = damped_step(&jacobian, &current, damping) else {
            break;
        };
        let next: Vec<f64> = u.iter().zip(&step).map(|(u, s)| u + s.clamp(-2.0, 2.0)).collect();
        let trial = residuals(&next);
        if sum(&trial) < sum(&current) {
            let gain = 1.0 - sum(&trial) / sum(&current);
            (u, current) = (next, trial);
            damping = (damping * 0.3).max(1e-14);
            if gain < 1e-12 && damping <= 1e-10 {
                break;
            }
        } else {
            damping *= 4.0;
            if damping > 1e12 {
                break;
            }
        }
    }
    let c = parameters.coefficients(&u, &poles);
    let formula = match terms {
        3 => SELLMEIER_1.with(&c),
        _ => {
            let c: Vec<f64> = std::iter::once(0.0).chain(c).collect();
            Formula::Numbered(NumberedFormula::new(2, &c).ok_or(FitError::Undetermined)?)
        }
    };
    Ok(Fit::of(formula, samples))
}

/// Maps unbounded numbers to poles that stay on their side of the samples.
struct Parameters {
    /// Upper bound of ultraviolet poles, um^2.
    ultraviolet: f64,
    /// Lower bound of infrared poles, um^2.
    infrared: f64,
}

impl Parameters {
    fn free(&self, pole: f64) -> f64 {
        if pole < self.infrared { libm::log(pole / (self.ultraviolet - pole)) } else { libm::log(pole - self.infrared) }
    }

    fn coefficients(&self, u: &[f64], start_poles: &[f64]) -> Vec<f64> {
        let pole = |v: f64, start: f64| {
            if start < self.infrared { self.ultraviolet / (1.0 + libm::exp(-v)) } else { self.infrared + libm::exp(v) }
        };
        u.chunks_exact(2).zip(start_poles).flat_map(|(u, &start)| [libm::exp(u[0]), pole(u[1], start)]).collect()
    }
}

fn square(c: &[f64], x: f64) -> f64 {
    c.chunks_exact(2).fold(1.0, |sum, term| sum + term[0] * x / (x - term[1]))
}

/// Computes strengths by linear least squares at the start poles; they are kept positive.
fn start_strengths(um2: &[f64], samples: &[Sample], poles: &[f64]) -> Vec<f64> {
    let matrix: Vec<f64> = um2.iter().flat_map(|&x| poles.iter().map(move |&m| x / (x - m))).collect();
    let right: Vec<f64> = samples.iter().map(|s| s.n * s.n - 1.0).collect();
    let share = right.iter().sum::<f64>() / right.len() as f64 / poles.len() as f64;
    let solution = linear::least_squares(&matrix, &right, poles.len());
    let fallback = (0.5 * share).max(1e-3);
    (0..poles.len())
        .map(|k| solution.as_ref().map_or(fallback, |s| s[k]))
        .map(|k| if k > 1e-4 { k } else { fallback })
        .collect()
}

/// Computes the Jacobian by central differences, one column per parameter.
fn jacobian(u: &[f64], residuals: &impl Fn(&[f64]) -> Vec<f64>) -> Vec<Vec<f64>> {
    let step = 1e-5;
    (0..u.len())
        .map(|k| {
            let shifted = |by: f64| {
                let mut u = u.to_vec();
                u[k] += by;
                residuals(&u)
            };
            shifted(step).iter().zip(shifted(-step)).map(|(a, b)| (a - b) / (2.0 * step)).collect()
        })
        .collect()
}

/// Returns the step that minimizes |J s + r|^2 + damping |D s|^2, as a least-squares system (no normal equations).
fn damped_step(jacobian: &[Vec<f64>], residuals: &[f64], damping: f64) -> Option<Vec<f64>> {
    let (rows, columns) = (residuals.len(), jacobian.len());
    let mut matrix = vec![0.0; (rows + columns) * columns];
    let mut right = vec![0.0; rows + columns];
    for i in 0..rows {
        for k in 0..columns {
            matrix[i * columns + k] = jacobian[k][i];
        }
        right[i] = -residuals[i];
    }
    for k in 0..columns {
        let norm = jacobian[k].iter().map(|j| j * j).sum::<f64>().sqrt().max(1e-12);
        matrix[(rows + k) * columns + k] = damping.sqrt() * norm;
    }
    linear::least_squares(&matrix, &right, columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    const N_BK7: [f64; 6] = [1.039_612_12, 0.006_000_698_67, 0.231_792_344, 0.020_017_914_4, 1.010_469_45, 103.560_653];

    #[test]
    fn three_resonances_of_n_bk7_come_back() {
        let made = SELLMEIER_1.with(&N_BK7);
        let samples: Vec<Sample> = [
            312.6, 334.1, 365.0, 404.7, 435.8, 486.1, 546.1, 587.6, 656.3, 706.5, 852.1, 1014.0, 1529.6, 1970.1, 2325.4,
        ]
        .map(|wavelength_nm| Sample { wavelength_nm, n: made.index(wavelength_nm) })
        .into();
        let fit = sellmeier_least_squares(&samples, 3).expect("determined");
        assert!(fit.max_deviation < 1e-7, "{}", fit.max_deviation);
        // Between the samples too.
        for i in 0..=200 {
            let w = 313.0 + 10.0 * f64::from(i);
            assert!((fit.formula.index(w) - made.index(w)).abs() < 1e-6, "{w}");
        }
    }

    /// One resonance in the ultraviolet, or one on either side: what made the samples comes back.
    #[test]
    fn fewer_resonances() {
        for (terms, c) in [(1, vec![0.0, 1.3, 0.0105]), (2, vec![0.0, 1.25, 0.0098, 0.9, 110.0])] {
            let made = Formula::Numbered(NumberedFormula::new(2, &c).expect("a form"));
            let samples: Vec<Sample> = (0..9)
                .map(|i| 365.0 + 80.0 * f64::from(i))
                .map(|wavelength_nm| Sample { wavelength_nm, n: made.index(wavelength_nm) })
                .collect();
            let fit = sellmeier_least_squares(&samples, terms).expect("determined");
            assert!(fit.max_deviation < 1e-9, "{terms}: {}", fit.max_deviation);
        }
    }

    #[test]
    fn refuses_what_determines_nothing() {
        let samples = [Sample { wavelength_nm: 500.0, n: 1.5 }; 6];
        assert_eq!(sellmeier_least_squares(&samples, 0), Err(FitError::Undetermined));
        assert_eq!(sellmeier_least_squares(&samples, 4), Err(FitError::Undetermined));
        assert_eq!(sellmeier_least_squares(&samples, 3), Err(FitError::Undetermined));
        assert_eq!(sellmeier_least_squares(&samples[..5], 3), Err(FitError::TooFew { needed: 6, found: 5 }));
    }
}
