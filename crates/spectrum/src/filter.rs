//! Passive matter and detectors: transmittance, reflectance, sensitivity.

use std::ops::Mul;

use spectra_core::spectral::Grid;

use crate::error::{SpectrumError, check};
use crate::gaussian::GaussianMixture;
use crate::meta::{Kind, Scale};
use crate::spectral_function::SpectralFunction;
use crate::tabulated::Tabulated;

/// Fraction of power that passes, by wavelength; from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Transmittance(SpectralFunction);

/// Fraction of power that is reflected, relative to the perfect diffuser; 0 or more, hardly above 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Reflectance(SpectralFunction);

/// Response of a detector per power that falls on it; 0 or more, in the unit of its table.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity(SpectralFunction);

macro_rules! filter {
    ($name:ident, $kind:expr, $what:literal) => {
        impl $name {
            /// Creates a spectrum with the same value at all wavelengths.
            ///
            /// # Errors
            /// [`SpectrumError::OutOfRange`] if `value` is negative or beyond the bound of its kind.
            pub fn constant(value: f64) -> Result<Self, SpectrumError> {
                Ok(Self(SpectralFunction::constant(check_value($kind, value)?)?))
            }

            /// Creates a rectangle: `value` from `from_nm` to `to_nm`, 0 elsewhere.
            ///
            /// # Errors
            /// [`SpectrumError::OutOfRange`]; see [`SpectralFunction::rectangle`].
            pub fn rectangle(from_nm: f64, to_nm: f64, value: f64) -> Result<Self, SpectrumError> {
                Ok(Self(SpectralFunction::rectangle(from_nm, to_nm)?.scaled(check_value($kind, value)?)?))
            }

            /// Creates a Gaussian of standard deviation `sigma_nm` and height `peak`.
            ///
            /// # Errors
            /// [`SpectrumError::OutOfRange`]; see [`SpectralFunction::gaussian`].
            pub fn gaussian(center_nm: f64, sigma_nm: f64, peak: f64) -> Result<Self, SpectrumError> {
                Ok(Self(SpectralFunction::gaussian(center_nm, sigma_nm)?.scaled(check_value($kind, peak)?)?))
            }

            /// Creates a signed sum of Gaussian terms. Where the sum falls a little below 0, it counts as 0.
            ///
            /// # Errors
            /// [`SpectrumError::OutOfRange`] if the sum is nowhere positive on 350-830 nm, falls below 0 there by more than a
            /// tenth of its largest value, or exceeds the bound of its kind.
            pub fn mixture(terms: GaussianMixture) -> Result<Self, SpectrumError> {
                let (shape, largest) = SpectralFunction::positive_mixture(terms)?;
                check_value($kind, largest)?;
                Ok(Self(shape))
            }

            /// Creates a spectrum from a table.
            ///
            /// # Errors
            /// [`SpectrumError::OutOfRange`] if a value is negative or beyond the bound of its kind.
            pub fn tabulated(table: Tabulated) -> Result<Self, SpectrumError> {
                let (low, high) = table.extremes();
                check_value($kind, low)?;
                check_value($kind, high)?;
                Ok(Self(SpectralFunction::tabulated(table)))
            }

            /// Creates a spectrum from points, linear between them, with the extension of its kind beyond the ends.
            ///
            /// # Errors
            /// [`SpectrumError::OutOfRange`]; see [`Tabulated::new`].
            pub fn from_points(wavelengths_nm: &[f64], values: &[f64]) -> Result<Self, SpectrumError> {
                let kind: Kind = $kind;
                Self::tabulated(Tabulated::new(wavelengths_nm, values, kind.outside(), Scale::Linear)?)
            }

            /// Creates a spectrum from a column of a file, which its reader has checked.
            pub(crate) fn from_checked(table: Tabulated) -> Self {
                Self(SpectralFunction::tabulated(table))
            }

            /// Creates a spectrum from a shape, whose values are checked on 350-830 nm.
            pub(crate) fn from_shape(shape: SpectralFunction) -> Result<Self, SpectrumError> {
                let (low, high) = shape.extremes();
                check_value($kind, low)?;
                check_value($kind, high)?;
                Ok(Self(shape))
            }

            #[doc = concat!("Returns the ", $what, " at `wavelength_nm`; 0 for NaN.")]
            #[must_use]
            pub fn at(&self, wavelength_nm: f64) -> f64 {
                self.0.at(wavelength_nm)
            }

            /// Returns the values on `grid`; see [`SpectralFunction::on_grid`].
            #[must_use]
            pub fn on_grid(&self, grid: &Grid) -> Vec<f64> {
                self.0.on_grid(grid)
            }

            /// Returns the function of wavelength that this spectrum wraps.
            #[must_use]
            pub fn shape(&self) -> &SpectralFunction {
                &self.0
            }
        }
    };
}

filter!(Transmittance, Kind::Transmittance, "transmittance");
filter!(Reflectance, Kind::Reflectance, "reflectance");
filter!(Sensitivity, Kind::Sensitivity, "sensitivity");

fn check_value(kind: Kind, value: f64) -> Result<f64, SpectrumError> {
    match kind {
        // A detector's response may be in any unit once it is not read from a file.
        Kind::Sensitivity => check("sensitivity", "0 or more", value, |v| v >= 0.0),
        Kind::Reflectance => check("reflectance", "between 0 and 1.5", value, |v| (0.0..=1.5).contains(&v)),
        _ => check("transmittance", "between 0 and 1 (1.02 for noise)", value, |v| (0.0..=1.02).contains(&v)),
    }
}

impl Sensitivity {
    /// Multiplies the sensitivity by a number.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] unless `factor` is finite and 0 or more.
    pub fn scaled(&self, factor: f64) -> Result<Self, SpectrumError> {
        Ok(Self(self.0.scaled(check("factor", "0 or more", factor, |f| f >= 0.0)?)?))
    }
}

/// Implements products of things that light meets one after the other; a product of two lights does not exist.
macro_rules! multiply {
    ($left:ident * $right:ident = $out:ident) => {
        impl Mul<&$right> for &$left {
            type Output = $out;
            fn mul(self, other: &$right) -> $out {
                $out(self.0.times(&other.0))
            }
        }
        impl Mul<$right> for $left {
            type Output = $out;
            fn mul(self, other: $right) -> $out {
                &self * &other
            }
        }
    };
}

multiply!(Transmittance * Transmittance = Transmittance);
multiply!(Transmittance * Reflectance = Reflectance);
multiply!(Reflectance * Transmittance = Reflectance);
multiply!(Reflectance * Reflectance = Reflectance);
multiply!(Sensitivity * Transmittance = Sensitivity);
multiply!(Transmittance * Sensitivity = Sensitivity);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gaussian::{GaussianTerm, fit_gaussians};
    use crate::{BAND, Emission, find_sensitivity};

    /// Ortho Plus as six Gaussians sees what its table sees, within the integral error of the fit.
    #[test]
    fn fitted_terms_are_a_detector() {
        let film = find_sensitivity("ilford-ortho-plus").expect("bundled");
        let fit = fit_gaussians(&BAND, &film.on_grid(&BAND), 6).expect("fits");
        let again = Sensitivity::mixture(fit.mixture).expect("almost nowhere negative");
        let light = Emission::constant(1.0).expect("valid");
        let (a, b) = (light.seen_by(&film, &BAND), light.seen_by(&again, &BAND));
        assert!((b / a - 1.0).abs() < 0.005, "{a} {b}");
        assert!(BAND.wavelengths_nm().all(|w| again.at(w) >= 0.0));
    }

    #[test]
    fn a_filter_passes_no_more_than_all() {
        let terms = |a| GaussianMixture::new(vec![GaussianTerm::new(a, 550.0, 30.0).expect("valid")]);
        assert!(Transmittance::mixture(terms(1.0)).is_ok() && Transmittance::mixture(terms(1.1)).is_err());
        assert!(Reflectance::mixture(terms(1.1)).is_ok() && Sensitivity::mixture(terms(900.0)).is_ok());
    }
}
