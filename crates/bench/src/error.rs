//! Errors of a benchmark.

use spectra_core::params::Faults;
use spectra_render::RenderError;

/// Why a benchmark cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The scene, or the parameters of a strategy, are invalid.
    #[error("{0}")]
    Faults(#[from] Faults),
    /// A strategy is written incorrectly, or is not registered.
    #[error("{0}")]
    Strategy(String),
    /// The numbers of samples or seeds are not usable.
    #[error("{0}")]
    Settings(&'static str),
    /// No channel records any light, so that a relative error has no meaning.
    #[error("no channel records any light of this scene")]
    Dark,
    /// No strategy is able to sample the scene.
    #[error("no strategy can sample this scene: {0}")]
    NoneLeft(String),
    /// A render failed with an error.
    #[error("{strategy}: {error}")]
    Render {
        /// Strategy of the failed render.
        strategy: String,
        /// Error of the renderer.
        error: RenderError,
    },
}
