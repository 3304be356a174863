//! What can go wrong.

use spectra_core::params::{Fault, Faults};
use spectra_core::sink::WriteFault;
use spectra_render::RenderError;
use spectra_scene::Scene;

/// Why a session could not do what it should.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// Everything that is wrong with the scene, each with its place.
    #[error("{0}")]
    Faults(Faults),
    /// What was asked for, this scene cannot have.
    #[error("{0}")]
    Request(String),
    /// The render failed.
    #[error("{0}")]
    Failed(String),
    /// A file that could not be written.
    #[error("{file}: cannot be written: {fault}{kept}")]
    Unwritten {
        /// The file.
        file: String,
        /// Why.
        fault: WriteFault,
        /// Where the light is kept instead, in words; empty where it is safe.
        kept: String,
    },
    /// Light of a render that cannot be taken up.
    #[error("{0}")]
    Light(#[from] std::io::Error),
}

impl SessionError {
    /// What the scene cannot have is a fault of the scene.
    pub(crate) fn of(error: &RenderError, scene: &Scene) -> Self {
        error.faults(scene).map_or_else(|| Self::Failed(error.to_string()), Self::Faults)
    }
}

impl From<Faults> for SessionError {
    fn from(faults: Faults) -> Self {
        Self::Faults(faults)
    }
}

impl From<Fault> for SessionError {
    fn from(fault: Fault) -> Self {
        Self::Faults(fault.into())
    }
}
