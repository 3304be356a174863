//! A spectrum of any kind.

use crate::emission::Emission;
use crate::filter::{Reflectance, Sensitivity, Transmittance};
use crate::meta::Kind;

/// A spectrum of any kind.
#[derive(Clone, Debug, PartialEq)]
pub enum AnySpectrum {
    /// Emitted light.
    Emission(Emission),
    /// The transmittance of a filter or another medium.
    Transmittance(Transmittance),
    /// The reflectance of a surface.
    Reflectance(Reflectance),
    /// The sensitivity of a detector.
    Sensitivity(Sensitivity),
}

impl AnySpectrum {
    /// Kind of the spectrum.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::Emission(_) => Kind::Emission,
            Self::Transmittance(_) => Kind::Transmittance,
            Self::Reflectance(_) => Kind::Reflectance,
            Self::Sensitivity(_) => Kind::Sensitivity,
        }
    }
}
