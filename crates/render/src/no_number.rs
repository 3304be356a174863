//! A number that is none, and the steps of a batch that one may come from.

use std::fmt;

/// The steps of a batch, each the work of one stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Wavelengths are drawn.
    Wavelengths,
    /// The source gives light.
    Source,
    /// Rays are aimed at the pupil.
    Pupil,
    /// The lens bends them.
    Lens,
    /// The imager launches or receives them.
    Imager,
    /// The channels weigh them.
    Response,
}

impl Step {
    /// The section of the scene that states the stage.
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

    /// What the stage gives.
    fn gives(self) -> &'static str {
        match self {
            Self::Wavelengths => "a wavelength or a density",
            Self::Source => "a radiance",
            Self::Pupil => "an aim",
            Self::Lens => "a place, a direction or a transmittance",
            Self::Imager => "a place or a weight",
            Self::Response => "a response",
        }
    }
}

/// A number that no light can have, and the stage that it comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct NoNumber {
    /// The step after which it was first seen.
    pub step: Step,
    /// The name of the stage, where the scene states one.
    pub kind: Option<String>,
    /// Wavelength of the ray, nm.
    pub wavelength_nm: f64,
    /// Whether it is infinite; else it is no number at all.
    pub infinite: bool,
}

impl fmt::Display for NoNumber {
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
