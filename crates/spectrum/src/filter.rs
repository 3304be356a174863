//! Passive matter and detectors: transmittance, reflectance, sensitivity.

use std::ops::Mul;

use spectra_core::spectral::Grid;

use crate::error::{SpectrumError, check};
use crate::meta::{Kind, Outside, Scale};
use crate::shape::Shape;
use crate::tabulated::Tabulated;

/// Share of power that passes, by wavelength; from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Transmittance(Shape);

/// Share of power that is thrown back, relative to the perfect diffuser; 0 or more, hardly above 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Reflectance(Shape);

/// Response of a detector per power that falls on it; 0 or more, in the unit of its table.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity(Shape);

macro_rules! filter {
    ($name:ident, $kind:expr, $what:literal) => {
        impl $name {
            /// The same value at all wavelengths.
            ///
            /// # Errors
            /// [`SpectrumError::OutOfRange`] if it is negative or beyond the bound of its kind.
            pub fn constant(value: f64) -> Result<Self, SpectrumError> {
                Ok(Self(Shape::constant(check_value($kind, value)?)?))
            }

            /// `value` from `from_nm` to `to_nm`, 0 elsewhere.
            ///
            /// # Errors
            /// [`SpectrumError::OutOfRange`]; see [`Shape::rectangle`].
            pub fn rectangle(from_nm: f64, to_nm: f64, value: f64) -> Result<Self, SpectrumError> {
                Ok(Self(
                    Shape::rectangle(from_nm, to_nm)?.scaled(check_value($kind, value)?)?,
                ))
            }

            /// A Gaussian of standard deviation `sigma_nm` and height `peak`.
            ///
            /// # Errors
            /// [`SpectrumError::OutOfRange`]; see [`Shape::gaussian`].
            pub fn gaussian(
                center_nm: f64,
                sigma_nm: f64,
                peak: f64,
            ) -> Result<Self, SpectrumError> {
                Ok(Self(
                    Shape::gaussian(center_nm, sigma_nm)?.scaled(check_value($kind, peak)?)?,
                ))
            }

            /// A table.
            ///
            /// # Errors
            /// [`SpectrumError::OutOfRange`] if a value is negative or beyond the bound of its kind.
            pub fn tabulated(table: Tabulated) -> Result<Self, SpectrumError> {
                let (low, high) = table.extremes();
                check_value($kind, low)?;
                check_value($kind, high)?;
                Ok(Self(Shape::tabulated(table)))
            }

            /// A table from memory, linear between its points, with its kind's extension beyond the ends.
            ///
            /// # Errors
            /// [`SpectrumError::OutOfRange`]; see [`Tabulated::new`].
            pub fn from_points(
                wavelengths_nm: &[f64],
                values: &[f64],
            ) -> Result<Self, SpectrumError> {
                let kind: Kind = $kind;
                Self::tabulated(Tabulated::new(
                    wavelengths_nm,
                    values,
                    kind.outside(),
                    Scale::Linear,
                )?)
            }

            /// A column of a file, whose reader has checked it.
            pub(crate) fn from_checked(table: Tabulated) -> Self {
                Self(Shape::tabulated(table))
            }

            /// A shape of values between 0 and 1.
            pub(crate) fn from_unit(shape: Shape) -> Self {
                Self(shape)
            }

            #[doc = concat!("The ", $what, " at `wavelength_nm`; 0 for NaN.")]
            #[must_use]
            pub fn at(&self, wavelength_nm: f64) -> f64 {
                self.0.at(wavelength_nm)
            }

            /// Values on `grid`; see [`Shape::on_grid`].
            #[must_use]
            pub fn on_grid(&self, grid: &Grid) -> Vec<f64> {
                self.0.on_grid(grid)
            }

            /// The bare function of wavelength.
            #[must_use]
            pub fn shape(&self) -> &Shape {
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
        Kind::Reflectance => check("reflectance", "between 0 and 1.5", value, |v| {
            (0.0..=1.5).contains(&v)
        }),
        _ => check(
            "transmittance",
            "between 0 and 1 (1.02 for noise)",
            value,
            |v| (0.0..=1.02).contains(&v),
        ),
    }
}

impl Sensitivity {
    /// A table of logarithms to base 10, linear between its points, 0 beyond the ends.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`]; see [`Tabulated::new`].
    pub fn from_log10_points(
        wavelengths_nm: &[f64],
        logarithms: &[f64],
    ) -> Result<Self, SpectrumError> {
        Self::tabulated(Tabulated::new(
            wavelengths_nm,
            logarithms,
            Outside::Zero,
            Scale::Log10,
        )?)
    }

    /// This times a number.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] unless it is finite and 0 or more.
    pub fn scaled(&self, factor: f64) -> Result<Self, SpectrumError> {
        Ok(Self(self.0.scaled(check(
            "factor",
            "0 or more",
            factor,
            |f| f >= 0.0,
        )?)?))
    }
}

/// What light meets one after the other; a product of two lights does not exist.
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
