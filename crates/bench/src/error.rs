//! Why a benchmark cannot be run.

use spectra_core::params::Faults;
use spectra_render::RenderError;

/// Why a benchmark cannot be run as asked.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The scene, or the parameters of a strategy, are wrong.
    #[error("{0}")]
    Faults(#[from] Faults),
    /// A strategy is written wrongly, or is not registered.
    #[error("{0}")]
    Strategy(String),
    /// The numbers of samples or seeds cannot be measured.
    #[error("{0}")]
    Settings(&'static str),
    /// Nothing is recorded: relative errors mean nothing.
    #[error("no channel records any light of this scene")]
    Dark,
    /// No strategy is left.
    #[error("no strategy can sample this scene: {0}")]
    NoneLeft(String),
    /// A render failed.
    #[error("{strategy}: {error}")]
    Render {
        /// Strategy that was rendered.
        strategy: String,
        /// What the renderer says.
        error: RenderError,
    },
}
