//! Scene files: YAML with places, assembly of stages, diagnostics.
//!
//! [`load`] reads a scene, finds all of its faults at once, and returns a [`Scene`]. Its stages are built, the lens is focused
//! and stopped down, and no ray is traced yet. [`load_series`] does so for a file that stands for several pictures.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod advice;
mod assemble;
pub mod bundled;
mod cast;
pub mod diagnostics;
mod doubts;
mod earlier;
mod films;
mod filters;
mod focus;
mod lamps;
mod landing;
mod language;
mod lens_section;
mod light_layer;
mod metering;
mod negatives;
mod output;
mod remembered;
mod resources;
mod responses;
mod said;
mod scene;
mod schema;
mod shot;
mod sight;
mod slips;

pub use spectra_yaml as yaml;

pub use cast::place as place_of_film;
pub use focus::{Focus, FocusBy};
pub use language::{
    Member, Series, SeriesKind, SweptAxis, document, load, load_series, series_of_text, series_of_tree,
};
pub use lens_section::{size_hint, size_hint_of, stop_hint_of};
pub use light_layer::{GhostPaths, LightKind, LightLayer};
pub use negatives::Negatives;
pub use output::{Holds, Output, OutputEntry, Told};
pub use resources::{FileResources, NO_LENS, NO_LENS_F_NUMBER};
pub use scene::{
    ConePattern, Direction, FilmTime, GhostSpread, Lights, MID_GRAY, NumberFamily, Reflections, RenderSettings, Scene,
    SceneFilm,
};
pub use schema::{FileKind, file_documentation, file_schema, shared_documentation};
pub use shot::{Developed, Shot};
pub use sight::Search;
pub use slips::other_films;
