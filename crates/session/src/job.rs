//! What to render, and how a job ended.

use crate::Names;
use serde_json::Value;
use spectra_core::Isa;
use spectra_darkroom::LightFrom;
use spectra_scene::Series;

/// A scene to render and write to files.
pub struct Job<'a> {
    /// The scene with all its pictures.
    pub series: &'a Series,
    /// Source of the light.
    pub light: LightFrom,
    /// Indices in the series of the pictures to render, if there are several.
    pub chosen: Vec<usize>,
    /// Whether pictures whose files all exist already are skipped.
    pub skip_existing: bool,
    /// Naming of the files.
    pub names: Names,
    /// Instruction set that rays are traced with.
    pub isa: Isa,
    /// Name of the scene's file, for the record.
    pub scene_file: String,
    /// Values set on top of the scene, for the record.
    pub overrides: Vec<String>,
    /// Version of the program, for the record.
    pub version: &'a str,
    /// Versions that a result depends on, for the record.
    pub versions: Value,
}

/// How a job ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JobEnd {
    /// Everything was done.
    Whole,
    /// The user stopped the job; finished pictures are written.
    Stopped,
}
