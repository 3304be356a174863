//! A spectrum on its way from what a person wrote to what is wanted.

use crate::by_name::Found;
use crate::emission::Emission;
use crate::error::{SpectrumError, check};
use crate::filter::{Reflectance, Sensitivity, Transmittance};
use crate::meta::Kind;
use crate::shape::Shape;

/// A spectrum whose kind is known, or a shape (a Gaussian, a constant) that can be of any.
#[derive(Clone, Debug)]
pub enum Piece {
    /// Light, matter or a detector.
    Typed(Found),
    /// A bare function of wavelength.
    Bare(Shape),
}

impl From<Emission> for Piece {
    /// Light.
    fn from(light: Emission) -> Self {
        Self::Typed(Found::Emission(light))
    }
}

impl Piece {
    /// As what is wanted, if it can be that; a spectrum of another kind stays what it is.
    pub(crate) fn into_found(self, wanted: Kind) -> Result<Found, SpectrumError> {
        match self {
            Self::Typed(found) => Ok(found),
            Self::Bare(shape) => of_shape(shape, wanted),
        }
    }

    /// One behind the other. A bare shape takes part as a filter.
    pub(crate) fn times(self, other: Self) -> Result<Self, SpectrumError> {
        use Found::{Emission as E, Reflectance as R, Sensitivity as S, Transmittance as T};
        let (left, right) = match (self, other) {
            (Self::Bare(a), Self::Bare(b)) => return Ok(Self::Bare(a.times(&b))),
            (Self::Typed(found), Self::Bare(shape)) | (Self::Bare(shape), Self::Typed(found)) => {
                return through(&found, &shape).map(Self::Typed);
            }
            (Self::Typed(a), Self::Typed(b)) => (a, b),
        };
        Ok(Self::Typed(match (left, right) {
            (E(light), T(filter)) | (T(filter), E(light)) => E(light * filter),
            (E(light), R(surface)) | (R(surface), E(light)) => E(light * surface),
            (T(a), T(b)) => T(a * b),
            (R(a), R(b)) => R(a * b),
            (T(filter), R(surface)) | (R(surface), T(filter)) => R(filter * surface),
            (S(detector), T(filter)) | (T(filter), S(detector)) => S(detector * filter),
            (a, b) => return Err(not_together(a.kind(), b.kind(), "product")),
        }))
    }

    /// Both at once. A bare shape takes part as what the other is.
    pub(crate) fn plus(self, other: Self) -> Result<Self, SpectrumError> {
        let (left, right) = match (self, other) {
            (Self::Bare(a), Self::Bare(b)) => return Ok(Self::Bare(a.plus(&b))),
            (Self::Typed(found), Self::Bare(shape)) | (Self::Bare(shape), Self::Typed(found)) => {
                let other = of_shape(shape, found.kind())?;
                (found, other)
            }
            (Self::Typed(a), Self::Typed(b)) => (a, b),
        };
        match (&left, &right) {
            (Found::Emission(a), Found::Emission(b)) => Ok(Self::Typed(Found::Emission(a + b))),
            (a, b) if a.kind() == b.kind() => match (shape_of(a), shape_of(b)) {
                (Some(x), Some(y)) => of_shape(x.plus(y), a.kind()).map(Self::Typed),
                _ => Err(not_together(a.kind(), b.kind(), "sum")),
            },
            (a, b) => Err(not_together(a.kind(), b.kind(), "sum")),
        }
    }

    /// Times a number of 0 or more.
    pub(crate) fn scaled(self, factor: f64) -> Result<Self, SpectrumError> {
        check("factor", "0 or more", factor, |f| f >= 0.0)?;
        match self {
            Self::Bare(shape) => Ok(Self::Bare(shape.scaled(factor)?)),
            Self::Typed(Found::Emission(light)) => Ok(Self::Typed(Found::Emission(light.scaled(factor)?))),
            Self::Typed(found) => match shape_of(&found) {
                Some(shape) => of_shape(shape.scaled(factor)?, found.kind()).map(Self::Typed),
                None => Ok(Self::Typed(found)),
            },
        }
    }
}

fn not_together(left: Kind, right: Kind, operation: &'static str) -> SpectrumError {
    SpectrumError::NotTogether { left: left.word(), right: right.word(), operation }
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

fn through(found: &Found, shape: &Shape) -> Result<Found, SpectrumError> {
    check("smallest value of a factor", "0 or more", shape.extremes().0, |v| v >= 0.0)?;
    match (found, shape_of(found)) {
        (Found::Emission(light), _) => Ok(Found::Emission(light.through(shape))),
        (found, Some(own)) => of_shape(own.times(shape), found.kind()),
        (found, None) => Ok(found.clone()),
    }
}

/// A shape as a spectrum of a kind, whose values are checked on 350-830 nm.
pub(crate) fn of_shape(shape: Shape, kind: Kind) -> Result<Found, SpectrumError> {
    Ok(match kind {
        Kind::Transmittance => Found::Transmittance(Transmittance::from_shape(shape)?),
        Kind::Reflectance => Found::Reflectance(Reflectance::from_shape(shape)?),
        Kind::Sensitivity => Found::Sensitivity(Sensitivity::from_shape(shape)?),
        _ => {
            check("power per nm", "0 or more", shape.extremes().0, |v| v >= 0.0)?;
            Found::Emission(Emission::new(Some(shape), Vec::new())?)
        }
    })
}
