//! The wavefront of the light that reaches a point of the film: how far it is out of phase across the opening.
//!
//! [`Waves`](crate::Wavefronts) traces optical paths from a node of the zones back to the point that it sees at the distance in focus. A
//! polynomial over direction cosines is fitted to them; its slope is the landing of the rays.

use spectra_numerics::linear::least_squares;

/// Degree of the polynomial that is fitted to a wavefront.
const DEGREE: usize = 8;
const TERMS: usize = (DEGREE + 1) * (DEGREE + 2) / 2;

/// The wavefront at a point of the film: the optical path (mm) relative to that of a perfect lens. It is a function of the
/// direction cosines in which the point sees the opening. Its slope is the landing position of the ray from there, mm from the
/// point (M. Born and E. Wolf, "Principles of optics", 5.1).
#[derive(Clone, Debug, PartialEq)]
pub struct Wavefront {
    center: [f64; 2],
    scale: f64,
    terms: Vec<f64>,
}

impl Wavefront {
    /// Fits a wavefront to optical paths (mm), each at a pair of direction cosines. `None` if there are too few pairs, or if they
    /// lie on a line.
    #[must_use]
    pub fn fitted(cosines: &[[f64; 2]], paths_mm: &[f64]) -> Option<Self> {
        let count = cosines.len() as f64;
        let center = [0, 1].map(|k| cosines.iter().map(|p| p[k]).sum::<f64>() / count);
        let away = |p: &[f64; 2]| (p[0] - center[0]).abs().max((p[1] - center[1]).abs());
        let scale = cosines.iter().map(away).fold(0.0, f64::max);
        // Subtract the mean of the paths: it is large compared with their differences, and has no meaning.
        let mean = paths_mm.iter().sum::<f64>() / count;
        let mut own = Self { center, scale, terms: Vec::new() };
        let rows: Vec<f64> = cosines.iter().flat_map(|p| own.powers(*p).0).collect();
        let differences: Vec<f64> = paths_mm.iter().map(|path| path - mean).collect();
        own.terms = least_squares(&rows, &differences, TERMS)?;
        Some(own)
    }

    /// Returns the optical path and its slopes along both cosines, all in mm.
    #[must_use]
    pub fn at(&self, cosines: [f64; 2]) -> (f64, [f64; 2]) {
        let (values, slopes) = self.powers(cosines);
        let sum = |powers: &[f64]| self.terms.iter().zip(powers).map(|(a, b)| a * b).sum::<f64>();
        (sum(&values), slopes.map(|powers| sum(&powers) / self.scale))
    }

    /// Returns the values of the terms at a place, and their slopes in units of the scale.
    fn powers(&self, cosines: [f64; 2]) -> ([f64; TERMS], [[f64; TERMS]; 2]) {
        let [x, y] = [0, 1].map(|k| {
            let v = (cosines[k] - self.center[k]) / self.scale;
            let mut powers = [1.0; DEGREE + 1];
            (1..DEGREE + 1).for_each(|n| powers[n] = powers[n - 1] * v);
            powers
        });
        let slope = |powers: &[f64; DEGREE + 1], n: usize| if n == 0 { 0.0 } else { n as f64 * powers[n - 1] };
        let (mut values, mut slopes) = ([0.0; TERMS], [[0.0; TERMS]; 2]);
        let mut at = 0;
        for degree in 0..DEGREE + 1 {
            for n in 0..degree + 1 {
                let m = degree - n;
                values[at] = x[m] * y[n];
                slopes[0][at] = slope(&x, m) * y[n];
                slopes[1][at] = x[m] * slope(&y, n);
                at += 1;
            }
        }
        (values, slopes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_is_found_with_its_slopes() {
        let wave = |[u, v]: [f64; 2]| 3e3 + 0.2 * u * u - 0.4 * u * v + 5.0 * u * v * v * v;
        let places: Vec<[f64; 2]> =
            (0..400).map(|k| [f64::from(k % 20) / 190.0 - 0.02, f64::from(k / 20) / 210.0 - 0.06]).collect();
        let found = Wavefront::fitted(&places, &places.iter().map(|p| wave(*p)).collect::<Vec<_>>()).unwrap();
        let [a, b] = [[0.013, 0.02], [0.05, -0.03]];
        assert!((found.at(a).0 - found.at(b).0 - (wave(a) - wave(b))).abs() < 1e-11);
        let slopes = found.at(a).1;
        let want = [0.4 * a[0] - 0.4 * a[1] + 5.0 * a[1].powi(3), -0.4 * a[0] + 15.0 * a[0] * a[1] * a[1]];
        assert!((0..2).all(|k| (slopes[k] - want[k]).abs() < 1e-9), "{slopes:?} {want:?}");
        assert_eq!(Wavefront::fitted(&places[..20], &[0.0; 20]), None);
    }
}
