//! Scene files: YAML with places, assembly of stages, diagnostics.
//!
//! [`load`] reads a scene, finds every fault of it at once, and gives a [`Scene`]: all stages built, the
//! lens focused and stopped, nothing traced yet.

mod assemble;
pub mod diagnostics;
mod films;
mod filters;
mod lens_section;
mod output;
mod resources;
mod scene;
mod schema;

pub use spectra_yaml as yaml;

pub use assemble::load;
pub use resources::FileResources;
pub use scene::{ConePattern, Direction, NumberFamily, Output, RaysFigure, RenderSettings, Scene, SceneFilm};
pub use schema::{FileKind, file_documentation, file_schema, shared_documentation};
