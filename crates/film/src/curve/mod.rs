//! Characteristic curves: optical density over the logarithm of exposure (Hurter and Driffield, 1890).
//!
//! ```
//! use spectra_film::curve::ToeShoulder;
//!
//! // ISO 80: 0.8/80 lx s gives 0.1 above base and fog; 1.5 further to the right, the density is 1.5 * 0.66 higher.
//! let curve = ToeShoulder::through([-2.0, 0.1], [-0.5, 0.1 + 1.5 * 0.66], 0.2, 2.5, 4.0).unwrap();
//! assert!((curve.density(-2.0) - 0.1).abs() < 1e-12);
//! ```

mod tabulated;
mod toe_shoulder;

pub use tabulated::TabulatedCurve;
pub use toe_shoulder::ToeShoulder;

/// Density above base and fog at which the speed of a negative film is measured (ISO 6:1993).
pub const SPEED_POINT_DENSITY: f64 = 0.1;

/// Interval of log10 exposure, from the speed point to the right, over which Ilford's data sheets state the average gradient.
pub const AVERAGE_GRADIENT_SPAN: f64 = 1.5;

/// Errors of characteristic curves.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CurveError {
    /// A parameter is outside its range.
    #[error("{what} must be {wanted}, not {value}")]
    OutOfRange {
        /// Name of the parameter.
        what: &'static str,
        /// Range of the parameter.
        wanted: &'static str,
        /// Value that was given.
        value: f64,
    },
    /// No curve of this family passes through the two points.
    #[error("a toe of {toe_width} leaves no room for the stated gradient; make it shorter")]
    ToeTooLong {
        /// Width of the toe, in log10 of exposure.
        toe_width: f64,
    },
    /// Exposures do not increase, or densities are not monotone.
    #[error("point {index} of the curve: {wanted}")]
    Order {
        /// Number of the point, from 1.
        index: usize,
        /// The rule that the point violates.
        wanted: &'static str,
    },
}

pub(crate) fn check(
    what: &'static str,
    wanted: &'static str,
    value: f64,
    test: impl Fn(f64) -> bool,
) -> Result<(), CurveError> {
    if value.is_finite() && test(value) { Ok(()) } else { Err(CurveError::OutOfRange { what, wanted, value }) }
}

/// Density over log10 of exposure in lx s; monotone, with a limit at both ends.
#[derive(Clone, Debug, PartialEq)]
pub enum CharacteristicCurve {
    /// A closed form, for films without a printed curve.
    ToeShoulder(ToeShoulder),
    /// A measured curve.
    Tabulated(TabulatedCurve),
}

impl CharacteristicCurve {
    /// Returns the density at an exposure, given as log10 of lx s; -infinity is no exposure.
    #[must_use]
    pub fn density(&self, log10_exposure: f64) -> f64 {
        match self {
            Self::ToeShoulder(c) => c.density(log10_exposure),
            Self::Tabulated(c) => c.density(log10_exposure),
        }
    }

    /// Returns the slope of the curve: density per unit of log10 exposure.
    #[must_use]
    pub fn gradient(&self, log10_exposure: f64) -> f64 {
        match self {
            Self::ToeShoulder(c) => c.gradient(log10_exposure),
            Self::Tabulated(c) => c.gradient(log10_exposure),
        }
    }

    /// Returns the curve shifted by `by` in log10 of the exposure. A closed form is not shifted, because its speed fixes it.
    #[must_use]
    pub(crate) fn slid(&self, by: f64) -> Self {
        match self {
            Self::ToeShoulder(_) => self.clone(),
            Self::Tabulated(c) => Self::Tabulated(c.slid(by)),
        }
    }

    /// Returns the range of log10 exposures over which all but a thousandth of the density changes.
    #[must_use]
    pub fn exposure_range(&self) -> (f64, f64) {
        match self {
            Self::Tabulated(c) => c.exposure_range(),
            Self::ToeShoulder(c) => {
                let (_, high) = self.density_range();
                let at = |share: f64| c.log10_exposure_at(share * high);
                (at(0.001).unwrap_or(-6.0), at(0.999).unwrap_or(6.0))
            }
        }
    }

    /// Density of the unexposed film, according to the curve.
    #[must_use]
    pub fn unexposed_density(&self) -> f64 {
        self.density(f64::NEG_INFINITY)
    }

    /// Smallest and largest density of the curve.
    #[must_use]
    pub fn density_range(&self) -> (f64, f64) {
        let (a, b) = (self.density(f64::NEG_INFINITY), self.density(f64::INFINITY));
        (a.min(b), a.max(b))
    }

    /// Finds the exposure, log10 of lx s, that gives `density`; `None` at and beyond the limits of the curve.
    #[must_use]
    pub fn log10_exposure_at(&self, density: f64) -> Option<f64> {
        match self {
            Self::ToeShoulder(c) => c.log10_exposure_at(density),
            Self::Tabulated(c) => c.log10_exposure_at(density),
        }
    }

    /// Finds the speed point: the exposure, log10 of lx s, that gives a density 0.1 above that of the unexposed film. `None` if
    /// no exposure does.
    #[must_use]
    pub fn speed_point(&self) -> Option<f64> {
        self.log10_exposure_at(self.unexposed_density() + SPEED_POINT_DENSITY)
    }

    /// Returns the slope of the straight line from the speed point to the point of the curve `span` further to the right in log10
    /// exposure. With [`AVERAGE_GRADIENT_SPAN`] this is Ilford's average gradient; ISO 6 uses 1.3. `None` if the curve has no
    /// speed point.
    #[must_use]
    pub fn average_gradient(&self, span: f64) -> Option<f64> {
        let from = self.speed_point()?;
        Some((self.density(from + span) - self.density(from)) / span)
    }
}

impl From<ToeShoulder> for CharacteristicCurve {
    fn from(curve: ToeShoulder) -> Self {
        Self::ToeShoulder(curve)
    }
}

impl From<TabulatedCurve> for CharacteristicCurve {
    fn from(curve: TabulatedCurve) -> Self {
        Self::Tabulated(curve)
    }
}
