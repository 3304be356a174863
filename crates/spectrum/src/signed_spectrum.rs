//! Spectra in a computation: of either sign, and checked only as a whole.

use crate::error::SpectrumError;
use crate::meta::Kind;
use crate::spectral_function::SpectralFunction;
use spectra_core::spectral::Line;

/// A spectrum that may be negative, such as a part of a sum or of a difference. Only light has lines.
#[derive(Clone, Debug)]
pub struct SignedSpectrum {
    /// Kind; `None` for a bare function of wavelength, which becomes whatever is wanted.
    pub(crate) kind: Option<Kind>,
    pub(crate) continuum: Option<SpectralFunction>,
    pub(crate) lines: Vec<Line>,
}

impl SignedSpectrum {
    /// Creates a spectrum with the same value everywhere.
    pub(crate) fn number(value: f64) -> Result<Self, SpectrumError> {
        Ok(Self { kind: None, continuum: Some(SpectralFunction::constant(value)?), lines: Vec::new() })
    }

    /// Multiplies by a number of either sign.
    pub(crate) fn scaled(&self, factor: f64) -> Result<Self, SpectrumError> {
        let continuum = self.continuum.as_ref().map(|shape| shape.scaled(factor)).transpose()?;
        let lines = self.lines.iter().map(|l| Line { power: l.power * factor, ..*l }).collect();
        Ok(Self { kind: self.kind, continuum, lines })
    }

    /// Adds two spectra. A bare function counts as the kind of the other.
    pub(crate) fn plus(&self, other: &Self) -> Result<Self, SpectrumError> {
        let kind = match (self.kind, other.kind) {
            (Some(a), Some(b)) if a != b => return Err(not_together(a, b, "sum")),
            (a, b) => a.or(b),
        };
        let continuum = match (&self.continuum, &other.continuum) {
            (Some(a), Some(b)) => Some(a.plus(b)),
            (one, None) | (None, one) => one.clone(),
        };
        Ok(Self { kind, continuum, lines: [self.lines.as_slice(), &other.lines].concat() })
    }

    /// Subtracts the other spectrum from this one.
    pub(crate) fn minus(&self, other: &Self) -> Result<Self, SpectrumError> {
        self.plus(&other.scaled(-1.0)?).map_err(|e| renamed(e, "difference"))
    }

    /// Multiplies two spectra, one behind the other.
    pub(crate) fn times(&self, other: &Self) -> Result<Self, SpectrumError> {
        use Kind::{Emission as E, Reflectance as R, Sensitivity as S, Transmittance as T};
        let kind = match (self.kind, other.kind) {
            (None, kind) | (kind, None) => kind,
            (Some(a), Some(b)) => Some(match (a, b) {
                (E, T | R) | (T | R, E) => E,
                (T, T) => T,
                (R, R | T) | (T, R) => R,
                (S, T) | (T, S) => S,
                (a, b) => return Err(not_together(a, b, "product")),
            }),
        };
        for (one, another) in [(self, other), (other, self)] {
            if let Some(factor) = one.continuum.as_ref().and_then(SpectralFunction::as_constant)
                && one.kind.is_none()
            {
                return Ok(Self { kind, ..another.scaled(factor)? });
            }
        }
        let through = |lines: &[Line], shape: &Option<SpectralFunction>| -> Vec<Line> {
            let at = |nm| shape.as_ref().map_or(0.0, |shape| shape.at(nm));
            lines.iter().map(|l| Line { power: l.power * at(l.wavelength_nm), ..*l }).collect()
        };
        let continuum = match (&self.continuum, &other.continuum) {
            (Some(a), Some(b)) => Some(a.times(b)),
            _ => None,
        };
        // No more than one of the two is light.
        let mut lines = through(&self.lines, &other.continuum);
        lines.extend(through(&other.lines, &self.continuum));
        Ok(Self { kind, continuum, lines })
    }

    /// Divides by the other spectrum. A quotient of two spectra of one kind is a bare function: a filter that turns one light
    /// into another.
    pub(crate) fn over(&self, other: &Self) -> Result<Self, SpectrumError> {
        use Kind::{Emission as E, Reflectance as R, Sensitivity as S, Transmittance as T};
        let kind = match (self.kind, other.kind) {
            (kind, None) => kind,
            (None, Some(_)) => None,
            (Some(a), Some(b)) if a == b => None,
            (Some(kind @ E), Some(T | R)) | (Some(kind @ (R | S)), Some(T)) => Some(kind),
            (Some(T), Some(R)) => None,
            (Some(a), Some(b)) => return Err(not_together(a, b, "quotient")),
        };
        let bare_of_lines = kind.is_none() && !self.lines.is_empty();
        let (Some(divisor), false) = (&other.continuum, !other.lines.is_empty() || bare_of_lines) else {
            return Err(SpectrumError::NotTogether {
                left: "a spectrum",
                right: "light with spectral lines",
                operation: "quotient",
            });
        };
        if let (Some(value), None) = (divisor.as_constant(), other.kind) {
            // Divide as written: a division by 0 is found when the whole is checked.
            let continuum = self.continuum.as_ref().map(|shape| shape.over(divisor));
            let lines = self.lines.iter().map(|l| Line { power: l.power / value, ..*l }).collect();
            return Ok(Self { kind, continuum, lines });
        }
        let lines = self.lines.iter().map(|l| Line { power: l.power / divisor.at(l.wavelength_nm), ..*l }).collect();
        Ok(Self { kind, continuum: self.continuum.as_ref().map(|shape| shape.over(divisor)), lines })
    }

    /// Raises to a power: a filter twice as thick, a transmittance from a density.
    pub(crate) fn to_the_power(&self, exponent: &Self) -> Result<Self, SpectrumError> {
        if let Some(kind) = exponent.kind {
            return Err(SpectrumError::NotTogether { left: "a spectrum", right: kind.word(), operation: "power" });
        }
        match (self.kind, &self.continuum, &exponent.continuum) {
            (Some(Kind::Emission), ..) | (_, None, _) | (.., None) => {
                Err(SpectrumError::NotTogether { left: "emission", right: "a number", operation: "power" })
            }
            (kind, Some(base), Some(exponent)) => {
                Ok(Self { kind, continuum: Some(base.to_the_power(exponent)), lines: Vec::new() })
            }
        }
    }
}

/// Merges lines at the same wavelength if any line is negative, and drops those that cancel.
pub(crate) fn joined(lines: Vec<Line>) -> Result<Vec<Line>, SpectrumError> {
    if let Some(line) = lines.iter().find(|l| !l.power.is_finite()) {
        return Err(SpectrumError::NotFinite { at_nm: line.wavelength_nm });
    }
    if lines.iter().all(|l| l.power >= 0.0) {
        return Ok(lines);
    }
    let mut sums: Vec<(Line, f64)> = Vec::new();
    for line in lines {
        match sums.iter_mut().find(|(sum, _)| sum.wavelength_nm == line.wavelength_nm) {
            Some((sum, size)) => {
                sum.power += line.power;
                *size += line.power.abs();
            }
            None => sums.push((line, line.power.abs())),
        }
    }
    let mut left = Vec::new();
    for (line, size) in sums {
        if line.power < -ROUNDING * size {
            return Err(SpectrumError::Negative {
                kind: "a line of emission",
                at_nm: line.wavelength_nm,
                value: line.power,
            });
        }
        if line.power > ROUNDING * size {
            left.push(line);
        }
    }
    Ok(left)
}

/// Largest rounding of a difference below 0, relative to what is subtracted.
const ROUNDING: f64 = 1e-12;
/// Largest roughness below 0 of a fit by signed Gaussians, relative to the largest value.
const ROUGHNESS: f64 = 0.1;

/// Makes a shape that cannot be negative. Where it is slightly negative by rounding, or as a fit is at its edges, it is cut off
/// at 0. Larger negative values are an error.
pub(crate) fn positive(shape: SpectralFunction, kind: Kind) -> Result<SpectralFunction, SpectrumError> {
    let survey = shape.survey();
    if let Some(at_nm) = survey.not_finite_nm {
        return Err(SpectrumError::NotFinite { at_nm });
    }
    let (value, at_nm) = survey.low;
    if value >= 0.0 {
        return Ok(shape);
    }
    let rounding = ROUNDING * shape.magnitude(at_nm);
    let roughness = if shape.has_mixture() { ROUGHNESS * survey.high.0 } else { 0.0 };
    if value < -roughness.max(rounding) {
        return Err(SpectrumError::Negative { kind: kind.word(), at_nm, value });
    }
    Ok(shape.at_least_zero())
}

fn not_together(left: Kind, right: Kind, operation: &'static str) -> SpectrumError {
    SpectrumError::NotTogether { left: left.word(), right: right.word(), operation }
}

fn renamed(error: SpectrumError, operation: &'static str) -> SpectrumError {
    match error {
        SpectrumError::NotTogether { left, right, .. } => SpectrumError::NotTogether { left, right, operation },
        other => other,
    }
}
