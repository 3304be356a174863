//! Scene files: YAML with places, assembly of stages, diagnostics.
//!
//! [`load`] reads a scene, finds all of its faults at once, and returns a [`Scene`]. Its stages are built, the lens is focused
//! and stopped down, and no ray is traced yet. [`load_series`] does so for a file that stands for several pictures.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod assemble;
mod build_messages;
pub mod bundled;
mod cached_resources;
mod color_cast;
pub mod diagnostics;
mod films;
mod filters;
mod focus;
mod frame_view;
mod hints;
mod keys;
mod lamps;
mod landing;
mod language;
mod lens_section;
mod light_layer;
mod metering;
mod mistake_hints;
mod negatives;
mod output;
mod render_section;
mod resources;
mod responses;
mod reuse;
mod scene;
mod scene_builder;
mod scene_file;
mod schema;
mod shot;
mod warnings;

pub use spectra_yaml as yaml;

pub use color_cast::place as place_of_film;
pub use focus::{Focus, FocusBy};
pub use frame_view::ViewSearch;
pub use keys::{FoundKeys, KeyPage, find_keys, key_pages, unit_of};
pub use language::{
    Member, Series, SeriesKind, SweptAxis, document, load, load_series, series_of_text, series_of_tree,
};
pub use lens_section::{size_hint, size_hint_of, stop_hint_of};
pub use light_layer::{GhostPaths, LightKind, LightLayer};
pub use mistake_hints::other_films;
pub use negatives::Negatives;
pub use output::{FileContent, Output, OutputEntry, SeriesSummary};
pub use resources::{FileResources, NO_LENS, NO_LENS_F_NUMBER};
pub use scene::{
    ConePattern, Direction, FilmTime, GhostSpread, Lights, MID_GRAY, NoiseLimit, NumberFamily, Reflections,
    RenderSettings, Scene, SceneFilm,
};
pub use schema::{FileKind, file_documentation, file_schema, shared_documentation};
pub use shot::{Developed, Shot};
