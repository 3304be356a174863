//! Emitted light: a continuum and lines.

use std::ops::{Add, Mul};

use spectra_core::spectral::{BAND, Grid, Line, SpectralPower};

use crate::cie::Observer;
use crate::constants::LUMINOUS_EFFICACY_LM_PER_W;
use crate::error::{SpectrumError, check};
use crate::filter::{Reflectance, Sensitivity, Transmittance};
use crate::gaussian::GaussianMixture;
use crate::spectral_function::SpectralFunction;
use crate::tabulated::Tabulated;

/// Emitted power (or radiance) by wavelength: a continuum per nanometer, and spectral lines stored separately.
///
/// A line of power p holds as much power as a continuum of p per nanometer that is one nanometer wide. The unit depends on the
/// source: relative for an illuminant, W m^-2 sr^-1 nm^-1 for a black body. [`Emission::scaled_to_luminance`] and
/// [`Emission::scaled_to_power`] make it absolute.
///
/// Light passes through matter and falls on detectors, but two lights have no product:
///
/// ```
/// use spectra_spectrum::{Emission, Transmittance};
/// let lamp = Emission::blackbody(2856.0)? * Transmittance::constant(0.5)?;
/// let two = &lamp + &Emission::line(589.3, 1.0)?;
/// # Ok::<(), spectra_spectrum::SpectrumError>(())
/// ```
///
/// ```compile_fail,E0277
/// use spectra_spectrum::Emission;
/// let nonsense = Emission::blackbody(2856.0).unwrap() * Emission::blackbody(6500.0).unwrap();
/// ```
///
/// ```compile_fail,E0369
/// use spectra_spectrum::{Reflectance, Transmittance};
/// let nonsense = Transmittance::constant(0.5).unwrap() + Reflectance::constant(0.5).unwrap();
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Emission {
    continuum: Option<SpectralFunction>,
    lines: Vec<Line>,
}

impl Emission {
    /// Creates light from a continuum per nanometer (`None`: lines only) and spectral lines.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] unless wavelengths of lines are positive and their powers 0 or more.
    pub fn new(continuum: Option<SpectralFunction>, lines: Vec<Line>) -> Result<Self, SpectrumError> {
        for line in &lines {
            check("wavelength of a line, nm", "positive", line.wavelength_nm, |w| w > 0.0)?;
            check("power of a line", "0 or more", line.power, |p| p >= 0.0)?;
        }
        Ok(Self { continuum, lines })
    }

    /// Creates monochromatic light: one line of this wavelength and power.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`]; see [`Emission::new`].
    pub fn line(wavelength_nm: f64, power: f64) -> Result<Self, SpectrumError> {
        Self::new(None, vec![Line { wavelength_nm, power }])
    }

    /// Creates light with `value` per nanometer at all wavelengths; 1 is illuminant E.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] unless `value` is finite and 0 or more.
    pub fn constant(value: f64) -> Result<Self, SpectrumError> {
        Self::new(
            Some(SpectralFunction::constant(check("power per nm", "0 or more", value, |v| v >= 0.0)?)?),
            Vec::new(),
        )
    }

    /// Creates light with 1 per nanometer from `from_nm` to `to_nm`.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`]; see [`SpectralFunction::rectangle`].
    pub fn rectangle(from_nm: f64, to_nm: f64) -> Result<Self, SpectrumError> {
        Self::new(Some(SpectralFunction::rectangle(from_nm, to_nm)?), Vec::new())
    }

    /// Creates a Gaussian of peak 1 per nanometer and standard deviation `sigma_nm`.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`]; see [`SpectralFunction::gaussian`].
    pub fn gaussian(center_nm: f64, sigma_nm: f64) -> Result<Self, SpectrumError> {
        Self::new(Some(SpectralFunction::gaussian(center_nm, sigma_nm)?), Vec::new())
    }

    /// Creates light from a signed sum of Gaussian terms, power per nanometer. Where the sum falls a little below 0, it is cut
    /// off at 0.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] if the sum is nowhere positive on 350-830 nm, or falls below 0 there by more than a tenth of
    /// its largest value.
    pub fn mixture(terms: GaussianMixture) -> Result<Self, SpectrumError> {
        Self::new(Some(SpectralFunction::positive_mixture(terms)?.0), Vec::new())
    }

    /// Creates the light of a black body, W m^-2 sr^-1 nm^-1.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`]; see [`SpectralFunction::blackbody`].
    pub fn blackbody(temperature_k: f64) -> Result<Self, SpectrumError> {
        Self::new(Some(SpectralFunction::blackbody(temperature_k)?), Vec::new())
    }

    /// Creates light from a table of power per nanometer.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] if a value is negative.
    pub fn tabulated(table: Tabulated) -> Result<Self, SpectrumError> {
        check("power per nm", "0 or more", table.extremes().0, |v| v >= 0.0)?;
        Self::new(Some(SpectralFunction::tabulated(table)), Vec::new())
    }

    /// Creates light from a histogram of measured power; see [`SpectralFunction::histogram`].
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] if a content is negative, and as [`SpectralFunction::histogram`].
    pub fn histogram(edges_nm: &[f64], contents: &[f64]) -> Result<Self, SpectrumError> {
        for content in contents {
            check("power of a bin", "0 or more", *content, |c| c >= 0.0)?;
        }
        Self::new(Some(SpectralFunction::histogram(edges_nm, contents)?), Vec::new())
    }

    /// Returns the first and last measured wavelength (nm) if the continuum is a table that continues with constant values beyond
    /// its ends; otherwise `None`.
    #[must_use]
    pub fn flat_beyond_nm(&self) -> Option<(f64, f64)> {
        self.continuum.as_ref().and_then(SpectralFunction::flat_beyond_nm)
    }

    /// Returns the continuum, per nanometer; `None` if there are only lines.
    #[must_use]
    pub fn continuum(&self) -> Option<&SpectralFunction> {
        self.continuum.as_ref()
    }

    /// Returns the spectral lines.
    #[must_use]
    pub fn lines(&self) -> &[Line] {
        &self.lines
    }

    /// Returns the continuum per nanometer at `wavelength_nm`.
    #[must_use]
    pub fn at(&self, wavelength_nm: f64) -> f64 {
        self.continuum.as_ref().map_or(0.0, |c| c.at(wavelength_nm))
    }

    /// Returns the continuum on `grid`; see [`SpectralFunction::on_grid`].
    #[must_use]
    pub fn on_grid(&self, grid: &Grid) -> Vec<f64> {
        self.continuum.as_ref().map_or_else(|| vec![0.0; grid.count], |c| c.on_grid(grid))
    }

    /// Returns the continuum on `grid`, and the lines within its band.
    #[must_use]
    pub fn to_power(&self, grid: &Grid) -> SpectralPower {
        let lines = self.lines.iter().filter(|l| grid.contains(l.wavelength_nm)).copied().collect();
        SpectralPower { grid: *grid, continuum: self.on_grid(grid), lines }
    }

    /// Multiplies the light by a number.
    ///
    /// # Errors
    /// [`SpectrumError::OutOfRange`] unless `factor` is finite and 0 or more.
    pub fn scaled(&self, factor: f64) -> Result<Self, SpectrumError> {
        check("factor", "0 or more", factor, |f| f >= 0.0)?;
        let continuum = self.continuum.as_ref().map(|c| c.scaled(factor)).transpose()?;
        let lines = self.lines.iter().map(|l| Line { power: l.power * factor, ..*l }).collect();
        Ok(Self { continuum, lines })
    }

    /// Returns the power over `grid`'s band: the integral of the continuum plus the lines.
    #[must_use]
    pub fn power(&self, grid: &Grid) -> f64 {
        let power = self.to_power(grid);
        grid.integrate(&power.continuum) + power.lines.iter().map(|l| l.power).sum::<f64>()
    }

    /// Returns the response of a detector to the light: the integral of power times sensitivity over `grid`'s band, lines included.
    #[must_use]
    pub fn seen_by(&self, sensitivity: &Sensitivity, grid: &Grid) -> f64 {
        let continuum = grid.integrate_product(&self.on_grid(grid), &sensitivity.on_grid(grid));
        let lines = self.lines.iter().filter(|l| grid.contains(l.wavelength_nm));
        continuum + lines.map(|l| l.power * sensitivity.at(l.wavelength_nm)).sum::<f64>()
    }

    /// Returns the luminance, cd/m^2, of a radiance in W m^-2 sr^-1 nm^-1: 683 lm/W times the integral over V(lambda).
    ///
    /// For an irradiance the result is the illuminance in lux, for a power in watts the luminous flux in lumens.
    #[must_use]
    pub fn luminance(&self) -> f64 {
        LUMINOUS_EFFICACY_LM_PER_W * Observer::cie_1931_2deg().xyz(self)[1]
    }

    /// Scales the light to a luminance of `cd_per_m2`. The continuum is then a radiance in W m^-2 sr^-1 nm^-1, and lines are in W
    /// m^-2 sr^-1.
    ///
    /// # Errors
    /// [`SpectrumError::NothingToScale`] if none of the light is visible, [`SpectrumError::OutOfRange`] for a luminance that is
    /// negative or not finite.
    pub fn scaled_to_luminance(&self, cd_per_m2: f64) -> Result<Self, SpectrumError> {
        check("luminance, cd/m2", "0 or more", cd_per_m2, |l| l >= 0.0)?;
        let now = self.luminance();
        if !(now > 0.0 && now.is_finite()) {
            return Err(SpectrumError::NothingToScale("luminance"));
        }
        self.scaled(cd_per_m2 / now)
    }

    /// Scales the light so that its power over 350-830 nm is `power`, in W or any other unit. The continuum is then in W/nm, and
    /// lines are in W.
    ///
    /// # Errors
    /// [`SpectrumError::NothingToScale`] if there is no power in that band, [`SpectrumError::OutOfRange`] for a power
    /// that is negative or not finite.
    pub fn scaled_to_power(&self, power: f64) -> Result<Self, SpectrumError> {
        check("power", "0 or more", power, |p| p >= 0.0)?;
        let now = self.power(&BAND);
        if !(now > 0.0 && now.is_finite()) {
            return Err(SpectrumError::NothingToScale("power"));
        }
        self.scaled(power / now)
    }

    /// Scales the light to a peak of 1. The peak is that of the continuum on the 1 nm grid; if there is no continuum, it is the
    /// power of the strongest line.
    ///
    /// # Errors
    /// [`SpectrumError::NothingToScale`] if there is no light.
    pub fn scaled_to_peak(&self) -> Result<Self, SpectrumError> {
        let continuum = self.on_grid(&BAND).into_iter().fold(0.0_f64, f64::max);
        let peak = if continuum > 0.0 { continuum } else { self.lines.iter().map(|l| l.power).fold(0.0, f64::max) };
        if peak > 0.0 { self.scaled(1.0 / peak) } else { Err(SpectrumError::NothingToScale("peak")) }
    }

    /// Returns the light that passes matter of this transmittance or reflectance.
    pub(crate) fn through(&self, shape: &SpectralFunction) -> Self {
        Self {
            continuum: self.continuum.as_ref().map(|c| c.times(shape)),
            lines: self.lines.iter().map(|l| Line { power: l.power * shape.at(l.wavelength_nm), ..*l }).collect(),
        }
    }
}

macro_rules! pass {
    ($matter:ident) => {
        impl Mul<&$matter> for &Emission {
            type Output = Emission;
            fn mul(self, matter: &$matter) -> Emission {
                self.through(matter.shape())
            }
        }
        impl Mul<$matter> for Emission {
            type Output = Emission;
            fn mul(self, matter: $matter) -> Emission {
                self.through(matter.shape())
            }
        }
    };
}

pass!(Transmittance);
pass!(Reflectance);

impl Add for &Emission {
    type Output = Emission;
    /// Returns the sum of both lights.
    fn add(self, other: &Emission) -> Emission {
        let continuum = match (&self.continuum, &other.continuum) {
            (Some(a), Some(b)) => Some(a.plus(b)),
            (Some(one), None) | (None, Some(one)) => Some(one.clone()),
            (None, None) => None,
        };
        Emission { continuum, lines: [self.lines.as_slice(), &other.lines].concat() }
    }
}

impl Add for Emission {
    type Output = Emission;
    fn add(self, other: Emission) -> Emission {
        &self + &other
    }
}

impl Observer {
    /// Returns the integral of `light` times each function over 350-830 nm, lines included; no factor is applied.
    ///
    /// For a radiance in W m^-2 sr^-1 nm^-1, Y times 683 lm/W is the luminance in cd/m^2.
    #[must_use]
    pub fn xyz(&self, light: &Emission) -> [f64; 3] {
        self.xyz_of_power(&light.to_power(&BAND))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_pass_matter_at_their_own_wavelength() {
        let light = Emission::line(450.5, 4.0).expect("valid") + Emission::constant(1.0).expect("valid");
        let out = &light * &Transmittance::from_points(&[400.0, 500.0], &[0.0, 1.0]).expect("valid");
        assert!((out.lines()[0].power - 4.0 * 0.505).abs() < 1e-15);
        assert!((out.at(425.0) - 0.25).abs() < 1e-15);
    }

    #[test]
    fn scaling_reaches_luminance_and_power() {
        let lamp = Emission::blackbody(3200.0).expect("valid") + Emission::line(546.074, 3.0).expect("valid");
        let lit = lamp.scaled_to_luminance(300.0).expect("has light");
        assert!((lit.luminance() - 300.0).abs() < 1e-10);
        let strong = lamp.scaled_to_power(2.5).expect("has light");
        assert!((strong.power(&BAND) - 2.5).abs() < 1e-12);
        // 1 W at 555 nm, where V is 1, is 683 lm.
        let green = Emission::line(555.0, 1.0).expect("valid");
        assert!((green.luminance() - 683.0).abs() < 1e-9, "{}", green.luminance());
    }

    #[test]
    fn darkness_has_no_scale() {
        let infrared = Emission::line(1064.0, 1.0).expect("valid");
        assert_eq!(infrared.scaled_to_luminance(1.0), Err(SpectrumError::NothingToScale("luminance")));
        assert_eq!(infrared.scaled_to_power(1.0), Err(SpectrumError::NothingToScale("power")));
        assert!(Emission::constant(1.0).expect("valid").scaled_to_luminance(-1.0).is_err());
    }

    #[test]
    fn negative_light_is_refused() {
        assert!(Emission::line(500.0, -1.0).is_err() && Emission::constant(-1.0).is_err());
        assert!(Emission::histogram(&[400.0, 410.0], &[-1.0]).is_err());
    }
}
