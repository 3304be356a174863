//! The index as a quotient of two polynomials in the wavelength or its square.

use crate::medium::Medium;
use spectra_numerics::linear;

/// The index as n = P(x) / Q(x), where x = s0 + s1 lambda + s2 lambda^2 runs from -1 to 1 over a band of light.
///
/// x is the scaled square of the wavelength (s1 = 0), in which the formulas of glasses are written; or the wavelength itself
/// (s2 = 0), in which Buchdahl's model is exactly a quotient of degree 2. P and Q have the same degree, and neither has a zero
/// in the band.
#[derive(Clone, Debug, PartialEq)]
pub struct Rational {
    /// s0, s1 (nm^-1), s2 (nm^-2).
    scale: [f64; 3],
    degree: usize,
    p: [f64; Rational::MAX_DEGREE + 1],
    q: [f64; Rational::MAX_DEGREE + 1],
}

/// A function of the wavelength that runs through the band.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Variable {
    /// The wavelength.
    Wavelength,
    /// The square of the wavelength.
    Square,
    /// The reciprocal of the squared wavelength: most nodes lie at the blue end, where glass disperses most.
    InverseSquare,
}

impl Variable {
    /// Returns s0, s1, s2 such that s0 + s1 lambda + s2 lambda^2 runs from -1 to 1 over the band.
    fn scale(self, min_nm: f64, max_nm: f64) -> [f64; 3] {
        match self {
            Variable::Wavelength => {
                let inverse_half = 2.0 / (max_nm - min_nm);
                [-0.5 * (min_nm + max_nm) * inverse_half, inverse_half, 0.0]
            }
            Variable::Square | Variable::InverseSquare => {
                let (low, high) = (min_nm * min_nm, max_nm * max_nm);
                let inverse_half = 2.0 / (high - low);
                [-0.5 * (low + high) * inverse_half, 0.0, inverse_half]
            }
        }
    }

    /// Returns the wavelength at which this variable is at `x` of its way from -1 to 1.
    fn wavelength_nm(self, min_nm: f64, max_nm: f64, x: f64) -> f64 {
        let between = |low: f64, high: f64| 0.5 * (low + high) + 0.5 * (high - low) * x;
        match self {
            Variable::Wavelength => between(min_nm, max_nm),
            Variable::Square => between(min_nm * min_nm, max_nm * max_nm).sqrt(),
            Variable::InverseSquare => 1.0 / between(1.0 / (min_nm * min_nm), 1.0 / (max_nm * max_nm)).sqrt(),
        }
    }
}

impl Rational {
    /// Largest degree of P and Q.
    pub const MAX_DEGREE: usize = 6;

    /// Finds the quotient of degree (`degree`, `degree`) in `variable` that meets the medium at 2 `degree` + 1 nodes. These are
    /// Chebyshev's nodes in `nodes`, a function of the wavelength.
    ///
    /// The conditions P(x_j) - n_j Q(x_j) = 0 are linear; the constant term of Q is 1. `None` if they have no solution, or one with
    /// a zero of P or Q in the band.
    pub(super) fn fit(
        medium: &Medium,
        min_nm: f64,
        max_nm: f64,
        degree: usize,
        variable: Variable,
        nodes: Variable,
    ) -> Option<Rational> {
        let count = 2 * degree + 1;
        let nodes: Vec<(f64, f64)> = (0..count)
            .map(|j| libm::cos(std::f64::consts::PI * (2 * j + 1) as f64 / (2 * count) as f64))
            .map(|node| nodes.wavelength_nm(min_nm, max_nm, node))
            .map(|w| (w, medium.index(w)))
            .collect();
        let start = Rational {
            scale: variable.scale(min_nm, max_nm),
            degree,
            p: [0.0; Rational::MAX_DEGREE + 1],
            q: [0.0; Rational::MAX_DEGREE + 1],
        };
        start.solve(&nodes, None)
    }

    /// Reduces the largest error of the fit on `checks` (wavelength and index) by steps of Remez's exchange. The error is
    /// leveled at its extrema, where P - (n + e) Q = 0 is made linear by the Q of the step before.
    pub(super) fn level(self, checks: &[(f64, f64)]) -> (Rational, f64) {
        let error_of = |r: &Rational| super::largest_error(checks, |w| r.evaluate(w));
        let mut best = (self.clone(), error_of(&self));
        let mut current = self;
        for _ in 0..6 {
            let Some(extrema) = current.extrema(checks) else {
                break;
            };
            let Some(next) = current.solve(&extrema, Some(&current)) else {
                break;
            };
            let error = error_of(&next);
            if error < best.1 {
                best = (next.clone(), error);
            }
            current = next;
        }
        best
    }

    /// Finds the point of largest error in each run of one sign, 2 `degree` + 2 of them; `None` if the error does not alternate
    /// exactly that often.
    fn extrema(&self, checks: &[(f64, f64)]) -> Option<Vec<(f64, f64)>> {
        let mut runs: Vec<(f64, (f64, f64))> = Vec::new();
        for &(w, n) in checks {
            let error = self.evaluate(w) - n;
            match runs.last_mut() {
                Some(run) if run.0 * error > 0.0 => {
                    if error.abs() > run.0.abs() {
                        *run = (error, (w, n));
                    }
                }
                _ if error == 0.0 => {}
                _ => runs.push((error, (w, n))),
            }
        }
        // More runs than unknowns mean rounding, or a fit that is better than it need be.
        (runs.len() == 2 * self.degree + 2).then(|| runs.into_iter().map(|run| run.1).collect())
    }

    /// Solves for P and Q at wavelengths and indices; with `levelled`, for an alternating error, too.
    fn solve(&self, points: &[(f64, f64)], levelled: Option<&Rational>) -> Option<Rational> {
        let (count, degree) = (points.len(), self.degree);
        let mut matrix = vec![0.0; count * count];
        let mut right = vec![0.0; count];
        let mut sign = 1.0;
        for (j, &(wavelength_nm, n)) in points.iter().enumerate() {
            let x = self.variable(wavelength_nm);
            let row = &mut matrix[j * count..(j + 1) * count];
            let mut power = 1.0;
            for k in 0..=degree {
                row[k] = power;
                if k > 0 {
                    row[degree + k] = -n * power;
                }
                power *= x;
            }
            if let Some(previous) = levelled {
                row[count - 1] = -sign * horner(&previous.q[..=degree], x);
                sign = -sign;
            }
            right[j] = n;
        }
        let solution = linear::solve(&matrix, &right)?;
        let mut rational = self.clone();
        rational.p[..=degree].copy_from_slice(&solution[..=degree]);
        rational.q[0] = 1.0;
        rational.q[1..=degree].copy_from_slice(&solution[degree + 1..2 * degree + 1]);
        (has_no_zero(&rational.p[..=degree]) && has_no_zero(&rational.q[..=degree])).then_some(rational)
    }

    #[inline(always)]
    fn variable(&self, wavelength_nm: f64) -> f64 {
        self.scale[0] + wavelength_nm * (self.scale[1] + wavelength_nm * self.scale[2])
    }

    /// Degree of P and of Q; 0 means a constant index.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Coefficients s0, s1 (nm^-1) and s2 (nm^-2) of x = s0 + lambda (s1 + lambda s2).
    #[must_use]
    pub fn scale(&self) -> [f64; 3] {
        self.scale
    }

    /// Index at a wavelength in nm.
    #[inline(always)]
    #[must_use]
    pub fn evaluate(&self, wavelength_nm: f64) -> f64 {
        match self.degree {
            0 => self.pair::<0>(wavelength_nm).0,
            1 => self.pair::<1>(wavelength_nm).0,
            2 => self.pair::<2>(wavelength_nm).0,
            3 => self.pair::<3>(wavelength_nm).0,
            4 => self.pair::<4>(wavelength_nm).0,
            5 => self.pair::<5>(wavelength_nm).0,
            _ => self.pair::<6>(wavelength_nm).0,
        }
    }

    /// Computes n and 1/n for each wavelength (nm) of a batch. The degree is tested once, and each loop is free of branches.
    #[inline(always)]
    pub fn index_and_inverse(&self, wavelength_nm: &[f64], n: &mut [f64], inverse_n: &mut [f64]) {
        match self.degree {
            0 => self.batch::<0>(wavelength_nm, n, inverse_n),
            1 => self.batch::<1>(wavelength_nm, n, inverse_n),
            2 => self.batch::<2>(wavelength_nm, n, inverse_n),
            3 => self.batch::<3>(wavelength_nm, n, inverse_n),
            4 => self.batch::<4>(wavelength_nm, n, inverse_n),
            5 => self.batch::<5>(wavelength_nm, n, inverse_n),
            _ => self.batch::<6>(wavelength_nm, n, inverse_n),
        }
    }

    #[inline(always)]
    fn batch<const DEGREE: usize>(&self, wavelength_nm: &[f64], n: &mut [f64], inverse_n: &mut [f64]) {
        for ((w, n), inverse) in wavelength_nm.iter().zip(n).zip(inverse_n) {
            (*n, *inverse) = self.pair::<DEGREE>(*w);
        }
    }

    /// Computes n = P P d and 1/n = Q Q d with d = 1 / (P Q): one division for both.
    #[inline(always)]
    fn pair<const DEGREE: usize>(&self, wavelength_nm: f64) -> (f64, f64) {
        let x = self.variable(wavelength_nm);
        let mut p = self.p[DEGREE];
        let mut q = self.q[DEGREE];
        for k in (0..DEGREE).rev() {
            p = p * x + self.p[k];
            q = q * x + self.q[k];
        }
        let d = 1.0 / (p * q);
        (p * p * d, q * q * d)
    }
}

fn horner(c: &[f64], x: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// Returns whether a polynomial (coefficients in ascending order of power) has no zero in [-1, 1]: its Bernstein coefficients,
/// over ever smaller parts of the interval, all have one sign. Returns false if it cannot tell.
fn has_no_zero(c: &[f64]) -> bool {
    // Coefficients of c(2 t - 1) by powers of t, by Horner's rule on polynomials; then of Bernstein's basis on [0, 1].
    let degree = c.len() - 1;
    let mut powers = vec![0.0; c.len()];
    for &c in c.iter().rev() {
        let mut next = vec![0.0; powers.len()];
        for k in 0..=degree {
            next[k] -= powers[k];
            if k < degree {
                next[k + 1] += 2.0 * powers[k];
            }
        }
        next[0] += c;
        powers = next;
    }
    let choose = |n: usize, k: usize| (1..=k).fold(1.0, |product, i| product * (n + 1 - i) as f64 / i as f64);
    let bernstein: Vec<f64> =
        (0..=degree).map(|i| (0..=i).map(|k| choose(i, k) / choose(degree, k) * powers[k]).sum()).collect();
    one_sign(&bernstein, 0)
}

fn one_sign(bernstein: &[f64], depth: usize) -> bool {
    if bernstein.iter().all(|b| *b > 0.0) || bernstein.iter().all(|b| *b < 0.0) {
        return true;
    }
    let last = bernstein.len() - 1;
    let same_ends = bernstein[0] * bernstein[last] > 0.0;
    if !same_ends || depth == 40 {
        return false;
    }
    // De Casteljau's split at the middle.
    let mut row = bernstein.to_vec();
    let mut left = vec![row[0]];
    let mut right = vec![row[last]];
    for length in (1..=last).rev() {
        for i in 0..length {
            row[i] = 0.5 * (row[i] + row[i + 1]);
        }
        left.push(row[0]);
        right.push(row[length - 1]);
    }
    right.reverse();
    one_sign(&left, depth + 1) && one_sign(&right, depth + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_are_seen() {
        assert!(has_no_zero(&[1.0]));
        assert!(has_no_zero(&[2.0, 1.0]));
        assert!(!has_no_zero(&[0.5, 1.0]));
        assert!(!has_no_zero(&[-0.25, 0.0, 1.0]));
        assert!(!has_no_zero(&[0.0, 0.0, 1.0]));
        // (x - 0.3)^2 + 1e-6: close to the axis, and free of it.
        assert!(has_no_zero(&[0.09 + 1e-6, -0.6, 1.0]));
        // A pole and a zero close together, as bad fits have them.
        assert!(!has_no_zero(&[-0.3, 1.0, 0.1, 0.0, 0.0, 0.01]));
        assert!(!has_no_zero(&[f64::NAN, 1.0]));
    }
}
