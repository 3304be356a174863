//! Spectral radiance of a black body.

use crate::constants::{FIRST_RADIATION_W_M2_PER_SR, SECOND_RADIATION_M_K};

/// Returns the spectral radiance of a black body in vacuum, W m^-2 sr^-1 nm^-1.
///
/// It is Planck's law, B = c1L / lambda^5 / (exp(c2 / (lambda T)) - 1), with the exact constants of the SI. The result is 0 for
/// a temperature or wavelength that is not positive.
#[must_use]
pub fn planck_radiance(wavelength_nm: f64, temperature_k: f64) -> f64 {
    if !(wavelength_nm > 0.0 && temperature_k > 0.0) {
        return 0.0;
    }
    let m = wavelength_nm * 1e-9;
    let fifth = m * m * m * m * m;
    let per_metre = FIRST_RADIATION_W_M2_PER_SR / (fifth * libm::expm1(SECOND_RADIATION_M_K / (m * temperature_k)));
    per_metre * 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constants::{STEFAN_BOLTZMANN_W_PER_M2_K4, WIEN_M_K};

    fn relative(got: f64, want: f64) -> f64 {
        (got / want - 1.0).abs()
    }

    /// CODATA values, all digits printed there.
    #[test]
    fn radiation_constants() {
        for (got, want, unit) in [
            (FIRST_RADIATION_W_M2_PER_SR, 1.191_042_972e-16, 1e-25),
            (SECOND_RADIATION_M_K, 1.438_776_878e-2, 1e-11),
            (WIEN_M_K, 2.897_771_955e-3, 1e-12),
            (STEFAN_BOLTZMANN_W_PER_M2_K4, 5.670_374_419e-8, 1e-17),
        ] {
            assert!((got - want).abs() <= unit, "{got:e} {want:e}");
        }
    }

    /// Computed independently with 30 digits from the CODATA constants.
    #[test]
    fn planck_values() {
        for (nm, kelvin, want) in [
            (500.0, 5000.0, 1.210_719_06e13),
            (560.0, 2856.0, 2.680_081_43e11),
            (555.0, 6500.0, 4.270_632_59e13),
            (450.0, 3000.0, 1.518_222_36e11),
        ] {
            let got = planck_radiance(nm, kelvin) * 1e9;
            assert!(relative(got, want) < 1e-8, "{got:e} {want:e}");
        }
        for (kelvin, want) in [(2856.0, 0.200_608_990), (6500.0, 1.348_097_52)] {
            let got = planck_radiance(450.0, kelvin) / planck_radiance(650.0, kelvin);
            assert!(relative(got, want) < 1e-8, "{got} {want}");
        }
    }

    /// Wien: the maximum lies at b / T. Stefan and Boltzmann: the integral is sigma T^4 / pi.
    #[test]
    fn maximum_and_integral_of_planck() {
        let kelvin = 5000.0;
        let peak = WIEN_M_K / kelvin * 1e9;
        let at_peak = planck_radiance(peak, kelvin);
        assert!(at_peak > planck_radiance(peak * 1.0001, kelvin) && at_peak > planck_radiance(peak / 1.0001, kelvin));
        // Trapezoids in ln(lambda): the integrand decays smoothly at both ends, so they converge fast.
        let (low, high, n) = (2.0_f64, 18.0_f64, 4000);
        let step = (high - low) / f64::from(n);
        let mut sum = 0.0;
        for i in 0..=n {
            let nm = libm::exp(low + step * f64::from(i));
            sum += planck_radiance(nm, kelvin) * nm * step;
        }
        let want = STEFAN_BOLTZMANN_W_PER_M2_K4 * kelvin.powi(4) / std::f64::consts::PI;
        assert!(relative(sum, want) < 1e-8, "{sum} {want}");
    }

    #[test]
    fn extremes_are_finite() {
        for (nm, kelvin) in [(1e-3, 10.0), (1e9, 1e6), (500.0, 0.0), (0.0, 5000.0), (-1.0, 300.0), (f64::NAN, 300.0)] {
            let got = planck_radiance(nm, kelvin);
            assert!(got >= 0.0 && got.is_finite(), "{nm} {kelvin}: {got}");
        }
    }
}
