//! Characteristic curves: optical density over the logarithm of exposure (Hurter and Driffield, 1890).
//!
//! ```
//! use spectra_film::curve::ToeShoulder;
//!
//! // ISO 80: 0.8/80 lx s gives 0.1 over base and fog; 1.5 further to the right, 0.66 a unit more.
//! let curve = ToeShoulder::through([-2.0, 0.1], [-0.5, 0.1 + 1.5 * 0.66], 0.2, 2.5, 4.0).unwrap();
//! assert!((curve.density(-2.0) - 0.1).abs() < 1e-12);
//! ```

mod tabulated;
mod toe_shoulder;

pub use tabulated::TabulatedCurve;
pub use toe_shoulder::ToeShoulder;

/// Density over base and fog at which the speed of a negative film is measured (ISO 6:1993).
pub const SPEED_POINT_DENSITY: f64 = 0.1;

/// Length on the axis of log10 exposure, from the speed point to the right, over which Ilford's sheets
/// state the average gradient.
pub const AVERAGE_GRADIENT_SPAN: f64 = 1.5;

/// A curve that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CurveError {
    /// A parameter outside of its range.
    #[error("{what} must be {wanted}, not {value}")]
    OutOfRange {
        /// The parameter.
        what: &'static str,
        /// What it may be.
        wanted: &'static str,
        /// What it was.
        value: f64,
    },
    /// No curve of this family passes through the two points.
    #[error("a toe of {toe_width} leaves no room for the stated gradient; make it shorter")]
    ToeTooLong {
        /// The toe's width, in log10 of exposure.
        toe_width: f64,
    },
    /// Points whose exposures do not increase, or whose densities turn.
    #[error("point {index} of the curve: {wanted}")]
    Order {
        /// The point, from 1.
        index: usize,
        /// What should hold.
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
    /// A closed form, for where no curve is printed.
    ToeShoulder(ToeShoulder),
    /// A measured curve.
    Tabulated(TabulatedCurve),
}

impl CharacteristicCurve {
    /// Density at an exposure, given as log10 of lx s; -infinity is no exposure.
    #[must_use]
    pub fn density(&self, log10_exposure: f64) -> f64 {
        match self {
            Self::ToeShoulder(c) => c.density(log10_exposure),
            Self::Tabulated(c) => c.density(log10_exposure),
        }
    }

    /// Slope of the curve: density per unit of log10 exposure.
    #[must_use]
    pub fn gradient(&self, log10_exposure: f64) -> f64 {
        match self {
            Self::ToeShoulder(c) => c.gradient(log10_exposure),
            Self::Tabulated(c) => c.gradient(log10_exposure),
        }
    }

    /// Returns the curve for `by` more in log10 of the exposure. A closed form stands where its speed put it.
    #[must_use]
    pub(crate) fn slid(&self, by: f64) -> Self {
        match self {
            Self::ToeShoulder(_) => self.clone(),
            Self::Tabulated(c) => Self::Tabulated(c.slid(by)),
        }
    }

    /// Where it bends: log10 exposures between which all but a thousandth of its density changes.
    #[must_use]
    pub fn span(&self) -> (f64, f64) {
        match self {
            Self::Tabulated(c) => c.span(),
            Self::ToeShoulder(c) => {
                let (_, high) = self.density_range();
                let at = |share: f64| c.log10_exposure_at(share * high);
                (at(0.001).unwrap_or(-6.0), at(0.999).unwrap_or(6.0))
            }
        }
    }

    /// Density of the unexposed film, as far as the curve holds it.
    #[must_use]
    pub fn unexposed_density(&self) -> f64 {
        self.density(f64::NEG_INFINITY)
    }

    /// Smallest and largest density.
    #[must_use]
    pub fn density_range(&self) -> (f64, f64) {
        let (a, b) = (self.density(f64::NEG_INFINITY), self.density(f64::INFINITY));
        (a.min(b), a.max(b))
    }

    /// The exposure, log10 of lx s, that gives `density`; `None` at and beyond the limits of the curve.
    #[must_use]
    pub fn log10_exposure_at(&self, density: f64) -> Option<f64> {
        match self {
            Self::ToeShoulder(c) => c.log10_exposure_at(density),
            Self::Tabulated(c) => c.log10_exposure_at(density),
        }
    }

    /// The exposure, log10 of lx s, that gives 0.1 over the unexposed film.
    #[must_use]
    pub fn speed_point(&self) -> Option<f64> {
        self.log10_exposure_at(self.unexposed_density() + SPEED_POINT_DENSITY)
    }

    /// Slope of the straight line from the speed point to the point `span` further to the right in log10
    /// exposure; Ilford's average gradient for a span of [`AVERAGE_GRADIENT_SPAN`], 1.3 in ISO 6.
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
