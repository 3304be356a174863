//! The Gaussian that touches a function at one point.

use super::GaussianTerm;
use crate::spectral_function::SpectralFunction;

/// Why no Gaussian touches a function at a point.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoGaussian {
    /// The function is 0 at that point (or not finite), so it has no logarithm.
    #[error("no Gaussian here: the value is {value}")]
    NoLogarithm {
        /// Value of the function at that point.
        value: f64,
    },
    /// The logarithm of the function does not bend down: its second derivative is 0 or more.
    #[error("no Gaussian here: the logarithm does not bend down, its second derivative is {curvature_per_nm2} nm^-2")]
    NotConcave {
        /// Second derivative of ln |f|, nm^-2.
        curvature_per_nm2: f64,
    },
}

impl GaussianTerm {
    /// Returns the Gaussian that has the given value, slope and second derivative at `wavelength_nm`, as a function has them
    /// there.
    ///
    /// The Gaussian follows from ln |f| of the function f: with g = f'/f and h = f''/f - g^2, sigma^2 is -1/h and the center lies
    /// sigma^2 g away. No such Gaussian exists where h is 0 or more, which is so in large parts of D65's band.
    ///
    /// # Errors
    /// [`NoGaussian`] says that there is none, and why.
    pub fn local(
        wavelength_nm: f64,
        value: f64,
        slope_per_nm: f64,
        curvature_per_nm2: f64,
    ) -> Result<Self, NoGaussian> {
        if value == 0.0 || !value.is_finite() {
            return Err(NoGaussian::NoLogarithm { value });
        }
        let slope = slope_per_nm / value;
        let curvature = curvature_per_nm2 / value - slope * slope;
        let variance = -1.0 / curvature;
        let center = wavelength_nm + variance * slope;
        let log_amplitude = libm::log(value.abs()) + 0.5 * variance * slope * slope;
        if !(curvature < 0.0 && variance.is_finite() && center.is_finite() && log_amplitude.is_finite()) {
            return Err(NoGaussian::NotConcave { curvature_per_nm2: curvature });
        }
        Ok(Self::of_log(value < 0.0, log_amplitude, center, variance.sqrt()))
    }

    /// Returns the Gaussian that touches `shape` at `wavelength_nm`. Slope and curvature come from central differences over
    /// `step_nm` to both sides.
    ///
    /// A table that is linear between its points has curvature only over steps of its own spacing or more.
    ///
    /// # Errors
    /// [`NoGaussian`] if there is none, also for a step that is not positive.
    pub fn local_of(shape: &SpectralFunction, wavelength_nm: f64, step_nm: f64) -> Result<Self, NoGaussian> {
        let [below, here, above] = [-step_nm, 0.0, step_nm].map(|d| shape.at(wavelength_nm + d));
        let slope = (above - below) / (2.0 * step_nm);
        let curvature = (above - 2.0 * here + below) / (step_nm * step_nm);
        Self::local(wavelength_nm, here, slope, curvature)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::find_emission;

    /// A Gaussian is its own best fit at any point.
    #[test]
    fn gaussian_is_found_from_any_point() {
        let term = GaussianTerm::new(-3.0, 540.0, 35.0).expect("valid");
        for x in [400.0, 520.0, 540.0, 700.0] {
            let (f, t) = (term.at(x), (x - 540.0) / 35.0);
            let (slope, curvature) = (-f * t / 35.0, f * (t * t - 1.0) / (35.0 * 35.0));
            let found = GaussianTerm::local(x, f, slope, curvature).expect("is a Gaussian");
            assert!((found.center_nm() - 540.0).abs() < 1e-9 && (found.sigma_nm() - 35.0).abs() < 1e-10, "{x}");
            assert!((found.peak() + 3.0).abs() < 1e-9, "{x}: {}", found.peak());
        }
    }

    /// Planck's law in wavelength: ln B = const - 5 ln x - ln(exp(c2 / (x T)) - 1), with derivatives in closed form.
    #[test]
    fn local_fit_of_a_black_body() {
        let shape = SpectralFunction::blackbody(5000.0).expect("valid");
        let (x, c2_over_t) = (550.0, crate::constants::SECOND_RADIATION_M_K * 1e9 / 5000.0);
        let y = c2_over_t / x;
        // d/dx ln B = -5/x + y/x * e^y/(e^y - 1).
        let q = y * libm::exp(y) / libm::expm1(y);
        let slope = (q - 5.0) / x;
        // d/dx: with dq/dx = -(y/x) dq/dy, dq/dy = q/y * (1 - y/(e^y - 1)).
        let dq = -q / x * (1.0 - y / libm::expm1(y));
        let curvature = dq / x - slope / x;
        let term = GaussianTerm::local_of(&shape, x, 0.1).expect("concave there");
        assert!((term.sigma_nm() / (-1.0 / curvature).sqrt() - 1.0).abs() < 1e-4, "{}", term.sigma_nm());
        assert!((term.at(x) / shape.at(x) - 1.0).abs() < 1e-12);
    }

    /// On large parts of D65 there is no Gaussian, and the function reports that.
    #[test]
    fn no_gaussian_is_an_answer() {
        let light = find_emission("D65").expect("bundled");
        let shape = light.continuum().expect("a continuum");
        let none = (380..=780).filter(|w| GaussianTerm::local_of(shape, f64::from(*w), 10.0).is_err()).count();
        assert!((120..280).contains(&none), "{none} of 401");
        assert!(matches!(
            GaussianTerm::local(500.0, 1.0, 0.0, 1.0),
            Err(NoGaussian::NotConcave { curvature_per_nm2: 1.0 })
        ));
        assert!(GaussianTerm::local(500.0, 1.0, 0.1, 0.0).is_ok());
        assert!(GaussianTerm::local(500.0, 1.0, 0.0, 0.0).is_err());
        assert!(matches!(GaussianTerm::local(500.0, 0.0, 0.0, -1.0), Err(NoGaussian::NoLogarithm { .. })));
        assert!(GaussianTerm::local(500.0, f64::NAN, 0.0, -1.0).is_err());
        assert!(GaussianTerm::local_of(shape, 500.0, 0.0).is_err());
    }
}
