//! Why a scene cannot be rendered.

use crate::Workers;
use crate::memory::bytes;
use crate::no_number::NoNumber;
use spectra_core::params::{Fault, Faults};
use spectra_scene::Scene;

/// Why a scene cannot be rendered as asked.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The source has no forward ability.
    #[error("this source cannot emit rays: render it backward")]
    CannotEmit,
    /// The imager has no forward ability.
    #[error("this imager cannot receive rays: render it backward")]
    CannotReceive,
    /// The imager has no backward ability.
    #[error("this imager cannot launch rays: render it forward")]
    CannotLaunch,
    /// The source has no backward ability.
    #[error("this source can only be rendered forward")]
    NoRadiance,
    /// What the source reads is broken.
    #[error("{0}")]
    Source(Faults),
    /// Whoever asked does not want it any more: no fault of the scene.
    #[error("stopped before the scene was made ready")]
    Stopped,
    /// No surface states a size.
    #[error("no surface of the lens states a semi-diameter: nothing says where light may enter")]
    NoAperture,
    /// The wavelength strategy refuses.
    #[error("wavelengths: {0}")]
    Sampler(String),
    /// A medium of the lens has no index in the band.
    #[error("lens: {0}")]
    Lens(String),
    /// The lens is none whose veiling glare is known.
    #[error("glare: {0}")]
    Glare(String),
    /// What the stop does to light is not known.
    #[error("diffraction: {0}")]
    Diffraction(String),
    /// A stage gave a number that no light can have.
    #[error("{0}")]
    NoNumber(NoNumber),
    /// A sum or a contribution did not fit.
    #[error(
        "the sums overflowed: a ray was {times:.1e} times as bright as the brightest of the {} that were tried before",
        crate::sums::PILOT_RAYS
    )]
    Overflow {
        /// How much brighter than the brightest ray of the pilot run.
        times: f64,
    },
    /// The sums of the picture do not fit into memory.
    #[error("the picture needs {} of memory, which the system refused", bytes(*.0))]
    Memory(u64),
    /// More samples are asked for than the scene states, of numbers that are made for so many.
    #[error("`numbers: {0}` are laid out for the samples that the scene states; no others can be added to them")]
    DoesNotExtend(&'static str),
}

impl RenderError {
    /// Why a search for what passes gave nothing.
    pub(crate) fn no_pupil(workers: &dyn Workers) -> Self {
        if workers.should_stop() { Self::Stopped } else { Self::NoAperture }
    }

    /// The same as a fault of the scene, at the section that has it; `None` for what is not the scene's doing.
    #[must_use]
    pub fn faults(&self, scene: &Scene) -> Option<Faults> {
        let at = |key: &str, text: &str, hint: &str| -> Option<Faults> {
            let key =
                key.split_once('.').filter(|(section, _)| scene.params.get(section).is_none()).map_or(key, |(s, _)| s);
            let fault: Fault = scene.params.fault(key, text).hint(hint);
            Some(fault.into())
        };
        let text = self.to_string();
        match self {
            Self::CannotEmit | Self::CannotReceive => at("render.direction", &text, "`direction: backward`"),
            Self::CannotLaunch | Self::NoRadiance => at("render.direction", &text, "`direction: forward`"),
            Self::NoAperture => at("lens", &text, spectra_scene::size_hint(scene.params.get("lens"))),
            // The strategy says in one text what is wrong and what to take.
            Self::Sampler(text) => match text.split_once("; ") {
                Some((text, hint)) => at("wavelengths", text, hint),
                None => at("wavelengths", text, "leave `wavelengths` out for the usual strategy"),
            },
            Self::Lens(text) => at("lens", text, "another glass, or another `wavelengths: {band: ...}`"),
            Self::Glare(text) => at("render.glare", text, "leave `glare` out, or take another lens"),
            Self::Diffraction(_) => at(
                "render.diffraction",
                &text,
                "`diffraction: false`, or a stop with blades or one that is drawn as an SVG in black and white",
            ),
            Self::NoNumber(found) => at(
                found.step.section(),
                &text,
                "a fault of that stage or of the data that it reads: try another one, or another `wavelengths: {band: ...}`",
            ),
            Self::Memory(_) => at("imager.resolution", &text, "fewer pixels, or fewer channels"),
            Self::Source(faults) => Some(faults.clone()),
            Self::DoesNotExtend(_) => at("render.numbers", &text, "`numbers: sobol`, which goes on at any length"),
            Self::Overflow { .. } | Self::Stopped => None,
        }
    }
}
