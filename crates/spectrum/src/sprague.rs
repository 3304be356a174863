//! Interpolation of smooth measurements.
//!
//! T. B. Sprague (1880), as recommended by CIE 167:2005, "Recommended practice for tabulating spectral data for use in colour
//! computations". Between two equally spaced points it takes the polynomial of fifth degree whose value, slope and curvature at
//! both points are those of the quartic through five neighbors.

/// Smallest number of points.
const LEAST: usize = 6;

/// Weights, over 209, of the first six points that give the two points before them, the farther one first. Reversed, they are
/// the weights for the last end.
const BEYOND: [[f64; 6]; 2] =
    [[884.0, -1960.0, 3033.0, -2648.0, 1080.0, -180.0], [508.0, -540.0, 488.0, -367.0, 144.0, -24.0]];

/// Returns whether the interpolation applies: there are six or more wavelengths, equally spaced.
pub(crate) fn applies(wavelengths_nm: &[f64]) -> bool {
    if wavelengths_nm.len() < LEAST {
        return false;
    }
    let step = (wavelengths_nm[wavelengths_nm.len() - 1] - wavelengths_nm[0]) / (wavelengths_nm.len() - 1) as f64;
    wavelengths_nm.windows(2).all(|w| ((w[1] - w[0]) / step - 1.0).abs() < 1e-6)
}

/// Returns point `index` of `values`, from -2 to two past the last.
fn point(values: &[f64], index: isize) -> f64 {
    let n = values.len();
    match usize::try_from(index) {
        Ok(i) if i < n => values[i],
        Ok(i) => {
            let weights = &BEYOND[1 - (i - n).min(1)];
            weights.iter().zip(values.iter().rev()).map(|(w, v)| w * v).sum::<f64>() / 209.0
        }
        Err(_) => {
            let weights = &BEYOND[usize::from(index == -1)];
            weights.iter().zip(values).map(|(w, v)| w * v).sum::<f64>() / 209.0
        }
    }
}

/// Interpolates at the share `x` (0 to 1) of the way from point `index` to the next; there must be at least six points.
pub(crate) fn between(values: &[f64], index: usize, x: f64) -> f64 {
    let i = index as isize;
    let [a, b, c, d, e, f] = [-2, -1, 0, 1, 2, 3].map(|k| point(values, i + k));
    let a1 = (2.0 * a - 16.0 * b + 16.0 * d - 2.0 * e) / 24.0;
    let a2 = (-a + 16.0 * b - 30.0 * c + 16.0 * d - e) / 24.0;
    let a3 = (-9.0 * a + 39.0 * b - 70.0 * c + 66.0 * d - 33.0 * e + 7.0 * f) / 24.0;
    let a4 = (13.0 * a - 64.0 * b + 126.0 * c - 124.0 * d + 61.0 * e - 12.0 * f) / 24.0;
    let a5 = (-5.0 * a + 25.0 * b - 50.0 * c + 50.0 * d - 25.0 * e + 5.0 * f) / 24.0;
    ((((a5 * x + a4) * x + a3) * x + a2) * x + a1) * x + c
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Within, a polynomial of fourth degree is reproduced; in the two intervals at either end, whose outer points are made
    /// up, a straight line; and the curve passes through all points.
    #[test]
    fn polynomials_are_reproduced() {
        let quartic = |x: f64| ((0.3 * x - 1.0) * x + 0.7) * x * x - 2.0 * x + 5.0;
        let line = |x: f64| 3.0 - 0.25 * x;
        let curved: Vec<f64> = (0..9).map(|i| quartic(f64::from(i))).collect();
        let straight: Vec<f64> = (0..9).map(|i| line(f64::from(i))).collect();
        for i in 0..8 {
            assert!((between(&curved, i, 0.0) - curved[i]).abs() < 1e-10);
            assert!((between(&curved, i, 1.0) - curved[i + 1]).abs() < 1e-10);
            for x in [0.1, 0.25, 0.5, 0.9] {
                assert!((between(&straight, i, x) - line(i as f64 + x)).abs() < 1e-12, "{i} {x}");
                if (2..6).contains(&i) {
                    assert!((between(&curved, i, x) - quartic(i as f64 + x)).abs() < 1e-9, "{i} {x}");
                }
            }
        }
    }

    #[test]
    fn it_wants_equal_steps() {
        assert!(applies(&[400.0, 410.0, 420.0, 430.0, 440.0, 450.0]));
        assert!(
            !applies(&[400.0, 410.0, 420.0, 430.0, 440.0]) && !applies(&[400.0, 410.0, 420.0, 430.0, 440.0, 451.0])
        );
    }
}
