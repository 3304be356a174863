//! Intermediate form of a spectrum between its written form and the kind that is expected.

use crate::emission::Emission;
use crate::error::{SpectrumError, check};
use crate::filter::{Reflectance, Sensitivity, Transmittance};
use crate::found::Found;
use crate::meta::Kind;
use crate::shape::Shape;
use crate::signed::{Signed, joined, positive};

/// Spectrum of known kind, or a shape (a Gaussian, a constant) that can be of any kind.
#[derive(Clone, Debug)]
pub enum Piece {
    /// Light, matter or a detector.
    Typed(Found),
    /// A function of wavelength without a kind.
    Bare(Shape),
    /// A part of a sum, with or without a kind. It may be negative: only the whole sum is checked.
    Signed(Signed),
}

impl From<Emission> for Piece {
    /// Wraps light as a spectrum of known kind.
    fn from(light: Emission) -> Self {
        Self::Typed(Found::Emission(light))
    }
}

impl From<Piece> for Signed {
    fn from(piece: Piece) -> Self {
        match piece {
            Piece::Bare(shape) => Self { kind: None, continuum: Some(shape), lines: Vec::new() },
            Piece::Signed(signed) => signed,
            Piece::Typed(found) => {
                let kind = Some(found.kind());
                match (&found, shape_of(&found)) {
                    (Found::Emission(light), _) => {
                        Self { kind, continuum: light.continuum().cloned(), lines: light.lines().to_vec() }
                    }
                    (_, shape) => Self { kind, continuum: shape.cloned(), lines: Vec::new() },
                }
            }
        }
    }
}

impl Piece {
    /// Converts the spectrum to the kind that is wanted, if it can be of that kind; a spectrum of another kind stays unchanged.
    pub(crate) fn into_found(self, wanted: Kind) -> Result<Found, SpectrumError> {
        match self {
            Self::Typed(found) => Ok(found),
            Self::Bare(shape) => of_shape(shape, wanted),
            Self::Signed(signed) => signed.settled()?.into_found(wanted),
        }
    }

    /// Multiplies both spectra. A bare shape takes part as a filter.
    pub(crate) fn times(self, other: Self) -> Result<Self, SpectrumError> {
        for factor in [&self, &other] {
            if let Self::Bare(shape) = factor {
                check("smallest value of a factor", "0 or more", shape.extremes().0, |v| v >= 0.0)?;
            }
        }
        Signed::from(self).times(&Signed::from(other))?.settled()
    }

    /// Adds both spectra; the sum is not yet checked. A bare shape takes part as the kind of the other.
    pub(crate) fn plus(self, other: Self) -> Result<Self, SpectrumError> {
        Ok(Self::Signed(Signed::from(self).plus(&Signed::from(other))?))
    }

    /// Multiplies the spectrum by a number of 0 or more.
    pub(crate) fn scaled(self, factor: f64) -> Result<Self, SpectrumError> {
        check("factor", "0 or more", factor, |f| f >= 0.0)?;
        Signed::from(self).scaled(factor)?.settled()
    }

    /// Checks a sum as a whole and gives it its kind.
    pub(crate) fn settled(self) -> Result<Self, SpectrumError> {
        match self {
            Self::Signed(signed) => signed.settled(),
            other => Ok(other),
        }
    }
}

impl Signed {
    /// Checks the sum as a whole. Without a kind it stays a bare function, which is checked once the wanted kind is known.
    pub(crate) fn settled(self) -> Result<Piece, SpectrumError> {
        let Some(kind) = self.kind else {
            return Ok(Piece::Bare(self.continuum.unwrap_or(Shape::constant(0.0)?)));
        };
        if kind != Kind::Emission {
            let shape = self.continuum.unwrap_or(Shape::constant(0.0)?);
            return of_shape(shape, kind).map(Piece::Typed);
        }
        let continuum = self.continuum.map(|shape| positive(shape, kind)).transpose()?;
        Emission::new(continuum, joined(self.lines)?).map(Piece::from)
    }
}

/// Returns the function of wavelength of matter or of a detector; `None` for light.
pub(crate) fn shape_of(found: &Found) -> Option<&Shape> {
    match found {
        Found::Emission(_) => None,
        Found::Transmittance(filter) => Some(filter.shape()),
        Found::Reflectance(surface) => Some(surface.shape()),
        Found::Sensitivity(detector) => Some(detector.shape()),
    }
}

/// Makes a spectrum of the given kind from a shape, and checks its values on 350-830 nm.
pub(crate) fn of_shape(shape: Shape, kind: Kind) -> Result<Found, SpectrumError> {
    let shape = positive(shape, kind)?;
    Ok(match kind {
        Kind::Transmittance => Found::Transmittance(Transmittance::from_shape(shape)?),
        Kind::Reflectance => Found::Reflectance(Reflectance::from_shape(shape)?),
        Kind::Sensitivity => Found::Sensitivity(Sensitivity::from_shape(shape)?),
        _ => Found::Emission(Emission::new(Some(shape), Vec::new())?),
    })
}
