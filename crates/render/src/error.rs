//! Errors that say why a scene cannot be rendered.

use crate::Workers;
use crate::memory::bytes;
use crate::non_finite::NonFinite;
use spectra_core::params::{Fault, Faults};
use spectra_scene::Scene;

/// The reason why a scene cannot be rendered as requested.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The source cannot emit rays, which forward rendering needs.
    #[error("this source cannot emit rays: render it backward")]
    CannotEmit,
    /// The imager cannot receive rays, which forward rendering needs.
    #[error("this imager cannot receive rays: render it backward")]
    CannotReceive,
    /// The imager cannot launch rays, which backward rendering needs.
    #[error("this imager cannot launch rays: render it forward")]
    CannotLaunch,
    /// The source cannot give its radiance along a ray, which backward rendering needs.
    #[error("this source can only be rendered forward")]
    NoRadiance,
    /// Files that the source reads are broken.
    #[error("{0}")]
    Source(Faults),
    /// The caller asked to stop; this is no fault of the scene.
    #[error("stopped before the scene was ready")]
    Stopped,
    /// No surface of the lens states a semi-diameter.
    #[error("no surface of the lens states a semi-diameter, so it is unknown where light can enter")]
    NoAperture,
    /// The wavelength strategy cannot be used in this scene.
    #[error("wavelengths: {}", .0.message)]
    Sampler(Box<Fault>),
    /// A medium of the lens has no refractive index somewhere in the band.
    #[error("lens: {0}")]
    Lens(String),
    /// The veiling glare of this lens cannot be computed.
    #[error("glare: {0}")]
    Glare(String),
    /// The diffraction at the stop of this lens cannot be computed.
    #[error("diffraction: {}", .0.message)]
    Diffraction(Box<Fault>),
    /// A stage gave a number that no light can have: NaN or infinite.
    #[error("{0}")]
    NonFinite(NonFinite),
    /// A sum, or one contribution to it, did not fit into the integers.
    #[error(
        "the sums overflowed: a ray was {times:.1e} times as bright as the brightest of the {} pilot rays",
        crate::sums::PILOT_RAYS
    )]
    Overflow {
        /// Brightness of the ray, as a multiple of the brightest ray of the pilot run.
        times: f64,
    },
    /// The sums of the picture, of this many bytes in all, do not fit into memory.
    #[error("the picture needs {} of memory, which the system could not provide", bytes(*.0))]
    Memory(u64),
    /// More or fewer samples were requested than the scene states, with random numbers that are laid out for exactly that many.
    #[error("`numbers: {0}` works only with exactly the number of samples that the scene states")]
    DoesNotExtend(&'static str),
}

impl RenderError {
    /// Returns the error for a pupil search that found nothing: it was stopped, or no surface states a size.
    pub(crate) fn no_pupil(workers: &dyn Workers) -> Self {
        if workers.should_stop() { Self::Stopped } else { Self::NoAperture }
    }

    /// Returns this error as a fault of the scene, located at the section that causes it; `None` if the scene is not the cause.
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
            Self::Sampler(fault) => {
                let hint = fault.hint.as_deref().unwrap_or("leave `wavelengths` out for the default strategy");
                at("wavelengths", &fault.message, hint)
            }
            Self::Lens(text) => at("lens", text, "use another glass, or another `wavelengths: {band: ...}`"),
            Self::Glare(text) => at("render.glare", text, "leave out `glare`, or use another lens"),
            Self::Diffraction(_) => at(
                "render.diffraction",
                &text,
                "write `diffraction: false`, or use a stop with blades or one drawn as a black and white SVG",
            ),
            Self::NonFinite(found) => at(
                found.step.section(),
                &text,
                "that stage or its data is faulty: try another one, or another `wavelengths: {band: ...}`",
            ),
            Self::Memory(_) => at("imager.resolution", &text, "use fewer pixels or fewer channels"),
            Self::Source(faults) => Some(faults.clone()),
            Self::DoesNotExtend(_) => at("render.numbers", &text, "`numbers: sobol`, which allows any number"),
            Self::Overflow { .. } | Self::Stopped => None,
        }
    }
}
