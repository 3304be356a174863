//! A number that is not finite, and the steps of a batch that it may come from.

use std::fmt;

/// The steps of tracing a batch, each the work of one stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The wavelengths are drawn.
    Wavelengths,
    /// The source gives its light.
    Source,
    /// The rays are aimed at the pupil.
    Pupil,
    /// The lens bends the rays.
    Lens,
    /// The imager launches or receives the rays.
    Imager,
    /// The channels weigh the rays by their responses.
    Response,
}

impl Step {
    /// Returns the section of the scene that states the stage.
    #[must_use]
    pub fn section(self) -> &'static str {
        match self {
            Self::Wavelengths => "wavelengths",
            Self::Source => "source",
            Self::Pupil | Self::Lens => "lens",
            Self::Imager => "imager",
            Self::Response => "film",
        }
    }

    /// Describes, for messages, what the stage returns.
    fn gives(self) -> &'static str {
        match self {
            Self::Wavelengths => "a wavelength or a density",
            Self::Source => "a radiance",
            Self::Pupil => "a direction toward the pupil",
            Self::Lens => "a position, a direction or a transmittance",
            Self::Imager => "a position or a weight",
            Self::Response => "a response",
        }
    }
}

/// A number that no light can have (infinite or NaN), and the stage that returned it.
#[derive(Clone, Debug, PartialEq)]
pub struct NonFinite {
    /// The step after which the number was first seen.
    pub step: Step,
    /// Kind of the stage, if the scene states one.
    pub kind: Option<String>,
    /// Wavelength of the ray, nm.
    pub wavelength_nm: f64,
    /// Whether the number is infinite; if false, it is NaN.
    pub infinite: bool,
}

impl fmt::Display for NonFinite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { step, kind, wavelength_nm, infinite } = self;
        match (step, kind) {
            (Step::Lens | Step::Pupil, _) => write!(f, "the lens")?,
            (Step::Response, _) => write!(f, "a channel of the film or imager")?,
            (_, Some(kind)) => write!(f, "{} `{kind}`", step.section())?,
            (_, None) => write!(f, "the stage in `{}`", step.section())?,
        }
        write!(f, " gave {} that is {}", step.gives(), if *infinite { "infinite" } else { "not a number" })?;
        if wavelength_nm.is_finite() { write!(f, ", at {wavelength_nm:.1} nm") } else { Ok(()) }
    }
}
