//! What is to be rendered, and how that ended.

use crate::Names;
use serde_json::Value;
use spectra_core::Isa;
use spectra_scene::Series;

/// What is to be rendered and written.
pub struct Job<'a> {
    /// The scene with all its pictures.
    pub series: &'a Series,
    /// Where the light comes from.
    pub light: LightFrom,
    /// Of several pictures, the places in the series of those that are wanted.
    pub chosen: Vec<usize>,
    /// Whether pictures whose files are all there are left as they are.
    pub skip_existing: bool,
    /// What files are called.
    pub names: Names,
    /// Instruction set.
    pub isa: Isa,
    /// For the record: how the scene's file was named.
    pub scene_file: String,
    /// For the record: what was set on top of it.
    pub overrides: Vec<String>,
    /// For the record: the version of the program.
    pub version: &'a str,
    /// For the record: the versions that a result depends on.
    pub versions: Value,
    /// The unit that a bare number at a path of a scene is read in.
    pub unit_of: &'a (dyn Fn(&str) -> Option<String> + Sync),
}

/// Where the light of a picture comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightFrom {
    /// Rays through the lens.
    #[default]
    Rays,
    /// The pixels of the scene's flat picture, as an ideal lens would image them: no ray is traced.
    Pixels,
}

/// How a job ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// All is done.
    Whole,
    /// Somebody stopped it; what was done is written.
    Stopped,
}
