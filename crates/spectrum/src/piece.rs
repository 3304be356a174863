//! A spectrum on its way from what a person wrote to what is wanted.

use crate::emission::Emission;
use crate::error::{SpectrumError, check};
use crate::filter::{Reflectance, Sensitivity, Transmittance};
use crate::found::Found;
use crate::meta::Kind;
use crate::shape::Shape;
use crate::signed::{Signed, joined, positive};

/// A spectrum whose kind is known, or a shape (a Gaussian, a constant) that can be of any.
#[derive(Clone, Debug)]
pub enum Piece {
    /// Light, matter or a detector.
    Typed(Found),
    /// A bare function of wavelength.
    Bare(Shape),
    /// A part of a sum, of a kind or bare: it may be negative, and is judged with the whole.
    Signed(Signed),
}

impl From<Emission> for Piece {
    /// Light.
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
    /// As what is wanted, if it can be that; a spectrum of another kind stays what it is.
    pub(crate) fn into_found(self, wanted: Kind) -> Result<Found, SpectrumError> {
        match self {
            Self::Typed(found) => Ok(found),
            Self::Bare(shape) => of_shape(shape, wanted),
            Self::Signed(signed) => signed.settled()?.into_found(wanted),
        }
    }

    /// One behind the other. A bare shape takes part as a filter.
    pub(crate) fn times(self, other: Self) -> Result<Self, SpectrumError> {
        for factor in [&self, &other] {
            if let Self::Bare(shape) = factor {
                check("smallest value of a factor", "0 or more", shape.extremes().0, |v| v >= 0.0)?;
            }
        }
        Signed::from(self).times(&Signed::from(other))?.settled()
    }

    /// Both at once, still to be judged as a whole. A bare shape takes part as what the other is.
    pub(crate) fn plus(self, other: Self) -> Result<Self, SpectrumError> {
        Ok(Self::Signed(Signed::from(self).plus(&Signed::from(other))?))
    }

    /// Times a number of 0 or more.
    pub(crate) fn scaled(self, factor: f64) -> Result<Self, SpectrumError> {
        check("factor", "0 or more", factor, |f| f >= 0.0)?;
        Signed::from(self).scaled(factor)?.settled()
    }

    /// Judged as a whole.
    pub(crate) fn settled(self) -> Result<Self, SpectrumError> {
        match self {
            Self::Signed(signed) => signed.settled(),
            other => Ok(other),
        }
    }
}

impl Signed {
    /// Judged as a whole: a bare function as one of a kind only where it is known what is wanted.
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

/// The function of matter and detectors.
pub(crate) fn shape_of(found: &Found) -> Option<&Shape> {
    match found {
        Found::Emission(_) => None,
        Found::Transmittance(filter) => Some(filter.shape()),
        Found::Reflectance(surface) => Some(surface.shape()),
        Found::Sensitivity(detector) => Some(detector.shape()),
    }
}

/// A shape as a spectrum of a kind, whose values are checked on 350-830 nm.
pub(crate) fn of_shape(shape: Shape, kind: Kind) -> Result<Found, SpectrumError> {
    let shape = positive(shape, kind)?;
    Ok(match kind {
        Kind::Transmittance => Found::Transmittance(Transmittance::from_shape(shape)?),
        Kind::Reflectance => Found::Reflectance(Reflectance::from_shape(shape)?),
        Kind::Sensitivity => Found::Sensitivity(Sensitivity::from_shape(shape)?),
        _ => Found::Emission(Emission::new(Some(shape), Vec::new())?),
    })
}
