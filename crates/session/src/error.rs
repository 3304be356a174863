//! Errors of a session.

use spectra_core::params::{Fault, Faults};
use spectra_core::sink::WriteFault;
use spectra_render::RenderError;
use spectra_scene::Scene;

/// Reasons why a session could not do what it was asked to.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// Every fault of the scene, each with its place.
    #[error("{0}")]
    Faults(Faults),
    /// A request that does not fit this scene.
    #[error("{0}")]
    Request(String),
    /// The render failed.
    #[error("{0}")]
    Failed(String),
    /// A file could not be written.
    #[error("{file}: cannot be written: {fault}{kept}")]
    Unwritten {
        /// Name of the file.
        file: String,
        /// Reason why it could not be written.
        fault: WriteFault,
        /// Message that says where the light was saved instead; empty if it is safe.
        kept: String,
    },
    /// Saved light of a render cannot be loaded.
    #[error("{0}")]
    Light(#[from] std::io::Error),
}

impl SessionError {
    /// Returns the error for a stage that failed, with its hint if it has one.
    #[must_use]
    pub fn of_stage(fault: Fault) -> Self {
        Self::Failed(fault.to_string())
    }

    /// Converts a render error: to faults of the scene if the scene caused it, otherwise to [`Self::Failed`].
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
