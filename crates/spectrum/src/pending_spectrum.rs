//! Intermediate form of a spectrum between its written form and the kind that is expected.

use crate::any_spectrum::AnySpectrum;
use crate::emission::Emission;
use crate::error::{SpectrumError, check};
use crate::filter::{Reflectance, Sensitivity, Transmittance};
use crate::meta::Kind;
use crate::signed_spectrum::{SignedSpectrum, joined, positive};
use crate::spectral_function::SpectralFunction;

/// A spectrum of known kind, or a function (a Gaussian, a constant) that can become any kind.
#[derive(Clone, Debug)]
pub enum PendingSpectrum {
    /// A spectrum of known kind: light, matter or a detector.
    Typed(AnySpectrum),
    /// A function of wavelength without a kind.
    Bare(SpectralFunction),
    /// A part of a sum, with or without a kind. It may be negative: only the whole sum is checked.
    Signed(SignedSpectrum),
}

impl From<Emission> for PendingSpectrum {
    /// Wraps light as a spectrum of known kind.
    fn from(light: Emission) -> Self {
        Self::Typed(AnySpectrum::Emission(light))
    }
}

impl From<PendingSpectrum> for SignedSpectrum {
    fn from(piece: PendingSpectrum) -> Self {
        match piece {
            PendingSpectrum::Bare(shape) => Self { kind: None, continuum: Some(shape), lines: Vec::new() },
            PendingSpectrum::Signed(signed) => signed,
            PendingSpectrum::Typed(found) => {
                let kind = Some(found.kind());
                match (&found, function_of(&found)) {
                    (AnySpectrum::Emission(light), _) => {
                        Self { kind, continuum: light.continuum().cloned(), lines: light.lines().to_vec() }
                    }
                    (_, shape) => Self { kind, continuum: shape.cloned(), lines: Vec::new() },
                }
            }
        }
    }
}

impl PendingSpectrum {
    /// Converts the spectrum to the kind that is wanted, if it can be of that kind; a spectrum of another kind stays unchanged.
    pub(crate) fn into_any(self, wanted: Kind) -> Result<AnySpectrum, SpectrumError> {
        match self {
            Self::Typed(found) => Ok(found),
            Self::Bare(shape) => spectrum_of_function(shape, wanted),
            Self::Signed(signed) => signed.settled()?.into_any(wanted),
        }
    }

    /// Multiplies both spectra. A bare shape takes part as a filter.
    pub(crate) fn times(self, other: Self) -> Result<Self, SpectrumError> {
        for factor in [&self, &other] {
            if let Self::Bare(shape) = factor {
                check("smallest value of a factor", "0 or more", shape.extremes().0, |v| v >= 0.0)?;
            }
        }
        SignedSpectrum::from(self).times(&SignedSpectrum::from(other))?.settled()
    }

    /// Adds both spectra; the sum is not yet checked. A bare shape takes part as the kind of the other.
    pub(crate) fn plus(self, other: Self) -> Result<Self, SpectrumError> {
        Ok(Self::Signed(SignedSpectrum::from(self).plus(&SignedSpectrum::from(other))?))
    }

    /// Multiplies the spectrum by a number of 0 or more.
    pub(crate) fn scaled(self, factor: f64) -> Result<Self, SpectrumError> {
        check("factor", "0 or more", factor, |f| f >= 0.0)?;
        SignedSpectrum::from(self).scaled(factor)?.settled()
    }

    /// Checks a sum as a whole and gives it its kind.
    pub(crate) fn settled(self) -> Result<Self, SpectrumError> {
        match self {
            Self::Signed(signed) => signed.settled(),
            other => Ok(other),
        }
    }
}

impl SignedSpectrum {
    /// Checks the sum as a whole. Without a kind it stays a bare function, which is checked once the wanted kind is known.
    pub(crate) fn settled(self) -> Result<PendingSpectrum, SpectrumError> {
        let Some(kind) = self.kind else {
            return Ok(PendingSpectrum::Bare(self.continuum.unwrap_or(SpectralFunction::constant(0.0)?)));
        };
        if kind != Kind::Emission {
            let shape = self.continuum.unwrap_or(SpectralFunction::constant(0.0)?);
            return spectrum_of_function(shape, kind).map(PendingSpectrum::Typed);
        }
        let continuum = self.continuum.map(|shape| positive(shape, kind)).transpose()?;
        Emission::new(continuum, joined(self.lines)?).map(PendingSpectrum::from)
    }
}

/// Returns the function of wavelength of matter or of a detector; `None` for light.
pub(crate) fn function_of(found: &AnySpectrum) -> Option<&SpectralFunction> {
    match found {
        AnySpectrum::Emission(_) => None,
        AnySpectrum::Transmittance(filter) => Some(filter.shape()),
        AnySpectrum::Reflectance(surface) => Some(surface.shape()),
        AnySpectrum::Sensitivity(detector) => Some(detector.shape()),
    }
}

/// Makes a spectrum of the given kind from a shape, and checks its values on 350-830 nm.
pub(crate) fn spectrum_of_function(shape: SpectralFunction, kind: Kind) -> Result<AnySpectrum, SpectrumError> {
    let shape = positive(shape, kind)?;
    Ok(match kind {
        Kind::Transmittance => AnySpectrum::Transmittance(Transmittance::from_shape(shape)?),
        Kind::Reflectance => AnySpectrum::Reflectance(Reflectance::from_shape(shape)?),
        Kind::Sensitivity => AnySpectrum::Sensitivity(Sensitivity::from_shape(shape)?),
        _ => AnySpectrum::Emission(Emission::new(Some(shape), Vec::new())?),
    })
}
