//! A closed-form curve with a toe, a nearly straight part and a shoulder.

use super::{CurveError, check};
use spectra_core::math::{exp, expm1, log, log1p, pow};

/// A density curve in closed form that rises from 0 above base and fog to a maximum.
///
/// With x the log10 of exposure, the toe is t = g w ln(1 + exp((x - a) / w)): 0 far to the left, a straight line of slope g far to the
/// right, curved over a few widths w around a.
/// The shoulder bends it below the maximum m: D = t / (1 + (t / m)^p)^(1/p). Both steps are monotone, smooth, and have an inverse in closed
/// form.
#[derive(Clone, Debug, PartialEq)]
pub struct ToeShoulder {
    foot: f64,
    slope: f64,
    toe_width: f64,
    maximum: f64,
    sharpness: f64,
}

impl ToeShoulder {
    /// Builds the curve through two points, each (log10 of exposure, density above base and fog), with a toe of width `toe_width` (log10 of
    /// exposure). The curve bends below `maximum_density`, more abruptly for a larger `shoulder_sharpness`.
    ///
    /// # Errors
    /// - [`CurveError::OutOfRange`]: the second point is not to the upper right of the first, a density is not between 0 and the maximum,
    ///   the width is not above 0 and at most 2, or the sharpness is outside 1 to 64.
    /// - [`CurveError::ToeTooLong`]: the toe rises too slowly to reach the second point.
    pub fn through(
        low: [f64; 2],
        high: [f64; 2],
        toe_width: f64,
        maximum_density: f64,
        shoulder_sharpness: f64,
    ) -> Result<Self, CurveError> {
        check("toe", "positive and at most 2", toe_width, |v| v > 0.0 && v <= 2.0)?;
        check("shoulder", "between 1 and 64", shoulder_sharpness, |v| (1.0..=64.0).contains(&v))?;
        check("log10 exposure of the first point", "finite", low[0], |_| true)?;
        check("log10 exposure of the second point", "larger than the first", high[0], |v| v > low[0])?;
        check("density of the first point", "positive", low[1], |v| v > 0.0)?;
        check("density of the second point", "larger than the first", high[1], |v| v > low[1])?;
        check("maximum density", "larger than the densities it limits", maximum_density, |v| v > high[1])?;
        let unfolded = |density: f64| unfold(density, maximum_density, shoulder_sharpness);
        let ratio = unfolded(high[1]) / unfolded(low[1]);
        let step = (high[0] - low[0]) / toe_width;
        // softplus(u + step) / softplus(u) falls from exp(step) to 1 as u rises: bisect for the ratio. At -700 softplus is near the
        // smallest normal number; at +700 it is straight to the last bit.
        let excess = |u: f64| softplus(u + step) / softplus(u) - ratio;
        let (mut left, mut right) = (-700.0, 700.0);
        if !(excess(left) > 0.0 && excess(right) < 0.0) {
            return Err(CurveError::ToeTooLong { toe_width });
        }
        loop {
            let middle = 0.5 * (left + right);
            if middle <= left || middle >= right {
                break;
            }
            if excess(middle) > 0.0 {
                left = middle;
            } else {
                right = middle;
            }
        }
        Ok(Self {
            foot: low[0] - left * toe_width,
            slope: unfolded(low[1]) / (toe_width * softplus(left)),
            toe_width,
            maximum: maximum_density,
            sharpness: shoulder_sharpness,
        })
    }

    /// Returns the density above base and fog at log10 of the exposure.
    #[must_use]
    pub fn density(&self, log10_exposure: f64) -> f64 {
        let straight = self.slope * self.toe_width * softplus((log10_exposure - self.foot) / self.toe_width);
        let (p, m) = (self.sharpness, self.maximum);
        // Divides the smaller of the two by the larger, so that neither power overflows.
        if straight <= m {
            straight / pow(1.0 + pow(straight / m, p), 1.0 / p)
        } else {
            m / pow(1.0 + pow(m / straight, p), 1.0 / p)
        }
    }

    /// Returns the density per unit of log10 exposure.
    #[must_use]
    pub fn gradient(&self, log10_exposure: f64) -> f64 {
        let u = (log10_exposure - self.foot) / self.toe_width;
        let straight = self.slope * self.toe_width * softplus(u);
        let (p, m) = (self.sharpness, self.maximum);
        self.slope / (1.0 + exp(-u)) * pow(1.0 + pow(straight / m, p), -1.0 / p - 1.0)
    }

    /// Finds log10 of the exposure that gives `density`; `None` unless it lies between 0 and the maximum.
    #[must_use]
    pub fn log10_exposure_at(&self, density: f64) -> Option<f64> {
        if !(density > 0.0 && density < self.maximum) {
            return None;
        }
        let s = unfold(density, self.maximum, self.sharpness) / (self.slope * self.toe_width);
        // ln(exp(s) - 1), without overflow for large s.
        Some(self.foot + self.toe_width * (s + log(-expm1(-s))))
    }
}

/// Returns ln(1 + exp(u)).
fn softplus(u: f64) -> f64 {
    u.max(0.0) + log1p(exp(-u.abs()))
}

/// Inverts the shoulder: returns the straight value that it bends to `density`.
fn unfold(density: f64, maximum: f64, sharpness: f64) -> f64 {
    density / pow(1.0 - pow(density / maximum, sharpness), 1.0 / sharpness)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve() -> ToeShoulder {
        ToeShoulder::through([-2.0, 0.1], [-0.5, 1.09], 0.2, 2.5, 4.0).expect("a film's curve")
    }

    #[test]
    fn passes_through_both_points() {
        let c = curve();
        assert!((c.density(-2.0) - 0.1).abs() < 1e-13);
        assert!((c.density(-0.5) - 1.09).abs() < 1e-13);
    }

    #[test]
    fn is_monotone_between_its_limits() {
        let c = curve();
        assert_eq!(c.density(f64::NEG_INFINITY), 0.0);
        assert_eq!(c.density(f64::INFINITY), 2.5);
        let mut before = 0.0;
        for i in 0..4000 {
            let d = c.density(-8.0 + f64::from(i) * 0.004);
            assert!(d > before || (d == before && d > 2.499_999), "{i}: {d} after {before}");
            before = d;
        }
        assert!(before < 2.5 + 1e-15);
    }

    #[test]
    fn gradient_is_the_derivative() {
        let c = curve();
        for i in 0..100 {
            let x = -4.0 + f64::from(i) * 0.07;
            let h = 1e-5;
            let numeric = (c.density(x + h) - c.density(x - h)) / (2.0 * h);
            // Central difference: h^2 / 6 of a third derivative below 20, plus rounding 1e-16 / h.
            assert!((c.gradient(x) - numeric).abs() < 1e-9, "{x}");
        }
    }

    #[test]
    fn inverse_returns_the_exposure() {
        let c = curve();
        for i in 0..60 {
            let x = -4.0 + f64::from(i) * 0.1;
            let back = c.log10_exposure_at(c.density(x)).expect("inside");
            assert!((back - x).abs() < 1e-9, "{x} {back}");
        }
        assert_eq!(c.log10_exposure_at(0.0), None);
        assert_eq!(c.log10_exposure_at(2.5), None);
        assert_eq!(c.log10_exposure_at(f64::NAN), None);
    }

    #[test]
    fn impossible_curves_are_refused() {
        let bad = |low, high, w, m, p| ToeShoulder::through(low, high, w, m, p).unwrap_err();
        assert!(matches!(bad([-2.0, 0.1], [-0.5, 1.09], 0.9, 2.5, 4.0), CurveError::ToeTooLong { .. }));
        for (low, high, w, m, p) in [
            ([-2.0, 0.1], [-2.5, 1.09], 0.2, 2.5, 4.0),
            ([-2.0, 0.1], [-0.5, 0.1], 0.2, 2.5, 4.0),
            ([-2.0, 0.0], [-0.5, 1.09], 0.2, 2.5, 4.0),
            ([-2.0, 0.1], [-0.5, 1.09], 0.0, 2.5, 4.0),
            ([-2.0, 0.1], [-0.5, 1.09], 0.2, 1.0, 4.0),
            ([-2.0, 0.1], [-0.5, 1.09], 0.2, 2.5, f64::NAN),
        ] {
            assert!(matches!(bad(low, high, w, m, p), CurveError::OutOfRange { .. }));
        }
    }
}
