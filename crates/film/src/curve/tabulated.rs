//! A measured curve: points joined by a monotone cubic.

use super::{CurveError, check};

/// Measured points joined by cubics that never overshoot, constant beyond the ends.
///
/// Slopes at the points are weighted harmonic means (F. N. Fritsch and J. Butland, "A method for constructing local monotone piecewise
/// cubic interpolants", SIAM J. Sci. Stat. Comput. 5 (1984), eq. 5). They are zero at the ends, where the curve meets its limits.
#[derive(Clone, Debug, PartialEq)]
pub struct TabulatedCurve {
    log10_exposure: Vec<f64>,
    density: Vec<f64>,
    slope: Vec<f64>,
}

impl TabulatedCurve {
    /// Builds a curve from points (log10 of exposure in lx s, density). Exposures increase; densities all rise (negative) or all fall
    /// (reversal), and equal neighbors are allowed.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`] for fewer than two points, numbers that are not finite, or densities outside 0 to 10;
    /// [`CurveError::Order`] if exposures do not increase or densities are not monotone.
    pub fn new(points: &[[f64; 2]]) -> Result<Self, CurveError> {
        check("number of points", "at least 2", points.len() as f64, |n| n >= 2.0)?;
        for p in points {
            check("log10 exposure", "finite", p[0], |_| true)?;
            check("density", "between 0 and 10", p[1], |d| (0.0..=10.0).contains(&d))?;
        }
        let rising = points[points.len() - 1][1] >= points[0][1];
        for (i, w) in points.windows(2).enumerate() {
            if w[1][0] <= w[0][0] {
                return Err(CurveError::Order { index: i + 2, wanted: "exposures must increase" });
            }
            if (w[1][1] != w[0][1]) && ((w[1][1] > w[0][1]) != rising) {
                return Err(CurveError::Order { index: i + 2, wanted: "densities must only rise or only fall" });
            }
        }
        let log10_exposure: Vec<f64> = points.iter().map(|p| p[0]).collect();
        let density: Vec<f64> = points.iter().map(|p| p[1]).collect();
        let mut slope = vec![0.0; points.len()];
        for i in 1..points.len() - 1 {
            let (h0, h1) = (log10_exposure[i] - log10_exposure[i - 1], log10_exposure[i + 1] - log10_exposure[i]);
            let (d0, d1) = ((density[i] - density[i - 1]) / h0, (density[i + 1] - density[i]) / h1);
            if d0 * d1 > 0.0 {
                let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
                slope[i] = (w0 + w1) / (w0 / d0 + w1 / d1);
            }
        }
        Ok(Self { log10_exposure, density, slope })
    }

    /// Returns the curve shifted by `by` to the right in log10 of the exposure.
    pub(crate) fn slid(&self, by: f64) -> Self {
        Self { log10_exposure: self.log10_exposure.iter().map(|x| x + by).collect(), ..self.clone() }
    }

    /// Log10 exposures of the first and the last point.
    #[must_use]
    pub fn exposure_range(&self) -> (f64, f64) {
        (self.log10_exposure[0], self.log10_exposure[self.log10_exposure.len() - 1])
    }

    /// Returns the density at log10 of the exposure.
    #[must_use]
    pub fn density(&self, log10_exposure: f64) -> f64 {
        let x = &self.log10_exposure;
        let last = x.len() - 1;
        // NaN most likely means no exposure.
        if log10_exposure.is_nan() || log10_exposure <= x[0] {
            return self.density[0];
        }
        if log10_exposure >= x[last] {
            return self.density[last];
        }
        let i = x.partition_point(|v| *v <= log10_exposure) - 1;
        self.in_segment(i, log10_exposure)
    }

    fn in_segment(&self, i: usize, at: f64) -> f64 {
        let h = self.log10_exposure[i + 1] - self.log10_exposure[i];
        let t = (at - self.log10_exposure[i]) / h;
        let (d0, d1) = (self.density[i], self.density[i + 1]);
        let (m0, m1) = (self.slope[i] * h, self.slope[i + 1] * h);
        let c2 = 3.0 * (d1 - d0) - 2.0 * m0 - m1;
        let c3 = 2.0 * (d0 - d1) + m0 + m1;
        d0 + t * (m0 + t * (c2 + t * c3))
    }

    /// Returns the density per unit of log10 exposure; 0 beyond the ends.
    #[must_use]
    pub fn gradient(&self, log10_exposure: f64) -> f64 {
        let x = &self.log10_exposure;
        if !(log10_exposure >= x[0] && log10_exposure < x[x.len() - 1]) {
            return 0.0;
        }
        let i = x.partition_point(|v| *v <= log10_exposure) - 1;
        let h = x[i + 1] - x[i];
        let t = (log10_exposure - x[i]) / h;
        let (d0, d1) = (self.density[i], self.density[i + 1]);
        let (m0, m1) = (self.slope[i] * h, self.slope[i + 1] * h);
        (m0 + t * (2.0 * (3.0 * (d1 - d0) - 2.0 * m0 - m1) + t * 3.0 * (2.0 * (d0 - d1) + m0 + m1))) / h
    }

    /// Finds log10 of the exposure that gives `density`; `None` at and beyond the limits. If the curve is level there, returns the leftmost
    /// such exposure.
    #[must_use]
    pub fn log10_exposure_at(&self, density: f64) -> Option<f64> {
        let last = self.density.len() - 1;
        let rising = self.density[last] >= self.density[0];
        let (low, high) = if rising { (0, last) } else { (last, 0) };
        if !(density > self.density[low] && density < self.density[high]) {
            return None;
        }
        let before = |d: f64| if rising { d < density } else { d > density };
        let i = self.density.partition_point(|d| before(*d)) - 1;
        let (mut left, mut right) = (self.log10_exposure[i], self.log10_exposure[i + 1]);
        loop {
            let middle = 0.5 * (left + right);
            if middle <= left || middle >= right {
                return Some(right);
            }
            if before(self.in_segment(i, middle)) {
                left = middle;
            } else {
                right = middle;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [[f64; 2]; 6] = [[-3.0, 0.2], [-2.5, 0.22], [-2.0, 0.4], [-1.0, 1.1], [0.0, 1.8], [0.5, 1.9]];

    #[test]
    fn interpolates_and_stays_monotone() {
        for sign in [1.0, -1.0] {
            let points: Vec<[f64; 2]> = POINTS.iter().map(|p| [p[0], 1.0 + sign * (p[1] - 1.0)]).collect();
            let c = TabulatedCurve::new(&points).expect("valid");
            for p in &points {
                assert!((c.density(p[0]) - p[1]).abs() < 1e-15);
            }
            let mut before = c.density(-4.0);
            for i in 0..=5000 {
                let d = c.density(-4.0 + f64::from(i) * 1e-3);
                assert!(sign * (d - before) >= -1e-15, "{i}");
                before = d;
            }
            assert_eq!(c.density(f64::NEG_INFINITY), points[0][1]);
            assert_eq!(c.density(f64::INFINITY), points[5][1]);
        }
    }

    /// A straight line has equal slopes at the inner points, and the cubic between such points is the line.
    #[test]
    fn straight_parts_stay_straight() {
        let points: Vec<[f64; 2]> = (0..8).map(|i| [f64::from(i) * 0.3, 0.1 + f64::from(i) * 0.2]).collect();
        let c = TabulatedCurve::new(&points).expect("valid");
        for i in 0..100 {
            let x = 0.3 + f64::from(i) / 100.0 * 1.5;
            assert!((c.density(x) - (0.1 + x / 1.5)).abs() < 1e-14, "{x}");
            assert!((c.gradient(x) - 1.0 / 1.5).abs() < 1e-12, "{x}");
        }
    }

    #[test]
    fn inverse_returns_the_exposure() {
        let c = TabulatedCurve::new(&POINTS).expect("valid");
        for i in 1..340 {
            let x = -2.99 + f64::from(i) * 0.01;
            let back = c.log10_exposure_at(c.density(x)).expect("inside");
            assert!((c.density(back) - c.density(x)).abs() < 1e-13, "{x} {back}");
        }
        assert_eq!(c.log10_exposure_at(0.2), None);
        assert_eq!(c.log10_exposure_at(2.0), None);
    }

    #[test]
    fn faulty_points_are_refused() {
        for points in [
            &[[0.0, 0.1]][..],
            &[[0.0, 0.1], [0.0, 0.2]],
            &[[0.0, 0.1], [1.0, 0.5], [2.0, 0.3]],
            &[[0.0, 0.1], [1.0, f64::NAN]],
            &[[0.0, -0.1], [1.0, 1.0]],
        ] {
            assert!(TabulatedCurve::new(points).is_err(), "{points:?}");
        }
    }
}
