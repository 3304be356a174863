//! Conversion of the coefficients of formulas whose wavelengths are in nanometers.

use super::{CAUCHY, CONRADY, ClosedForm, ClosedFormula, Formula, SCHOTT, SELLMEIER_1};

/// Powers of the wavelength in Schott's terms.
const SCHOTT_POWERS: [f64; 6] = [0.0, 2.0, -2.0, -4.0, -6.0, -8.0];
/// Powers of the wavelength in Conrady's terms.
const CONRADY_POWERS: [f64; 3] = [0.0, -1.0, -3.5];

impl Formula {
    /// Converts a formula with coefficients for wavelengths in nanometers to one with coefficients for micrometers. `None` for
    /// forms whose conversion is not known.
    #[must_use]
    pub fn in_micrometers(self) -> Option<Self> {
        let Self::Closed(closed) = &self else {
            // A formula without a wavelength has no unit to convert.
            return matches!(self, Self::Constant(_)).then_some(self);
        };
        let is = |form: &ClosedForm| closed.name() == form.name;
        // Power of the wavelength that each coefficient multiplies. Sellmeier's poles are subtracted from L^2, so they count as
        // its negative.
        let power: fn(usize) -> Option<f64> = match () {
            () if is(&CAUCHY) => |k| Some(-2.0 * k as f64),
            () if is(&CONRADY) => |k| CONRADY_POWERS.get(k).copied(),
            () if is(&SCHOTT) => |k| SCHOTT_POWERS.get(k).copied(),
            () if is(&SELLMEIER_1) => |k| Some(if k % 2 == 0 { 0.0 } else { -2.0 }),
            () => return None,
        };
        let given = closed.coefficients().iter().enumerate();
        let converted: Option<Vec<f64>> = given.map(|(k, c)| Some(c * libm::pow(1000.0, power(k)?))).collect();
        Some(Self::Closed(ClosedFormula::again(closed, &converted?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coefficients for nanometers give the indices of those for micrometers.
    #[test]
    fn units_of_the_wavelength_make_no_difference() {
        let pairs: [(ClosedForm, &[f64], &[f64]); 4] = [
            (CAUCHY, &[1.5046, 0.0042, 1.1e-4], &[1.5046, 4200.0, 1.1e8]),
            (CONRADY, &[1.45217, 0.01258, 6.659e-5], &[1.45217, 12.58, 6.659e-5 * 3.162_277_660_168_379_3e10]),
            (SCHOTT, &[2.27, -0.0101, 0.0106, 2.08e-4], &[2.27, -1.01e-8, 10_600.0, 2.08e8]),
            (SELLMEIER_1, &[1.04, 0.006, 0.23, 0.02, 1.01, 103.5], &[1.04, 6000.0, 0.23, 20_000.0, 1.01, 1.035e8]),
        ];
        for (form, um, nm) in pairs {
            let (um, nm) = (form.with(um), form.with(nm).in_micrometers().expect("known"));
            for wavelength in [400.0, 550.0, 700.0] {
                let [a, b] = [&um, &nm].map(|f| f.index(wavelength));
                assert!((a - b).abs() < 1e-12, "{}: {a} {b}", form.name);
            }
        }
        assert!(Formula::Constant(1.5).in_micrometers().is_some());
        assert!(crate::formula::HERZBERGER.with(&[1.5]).in_micrometers().is_none());
    }
}
