//! What a program lends to a session, and hears of it.

use crate::{Control, Report, Workers};
use serde_json::Value;
use spectra_core::params::Warning;
use spectra_core::sink::Sink;
use spectra_scene::Scene;
use std::path::Path;
use std::sync::Arc;

/// A picture among several.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Its number: in the sweep, or of the frame.
    pub number: u32,
    /// How many are rendered before it.
    pub index: usize,
    /// How many there are.
    pub of: usize,
}

/// What goes on.
#[derive(Clone, Copy)]
pub enum Event<'a> {
    /// So many pictures of a series were looked at.
    Checked {
        /// How many.
        done: usize,
        /// Of how many.
        of: usize,
    },
    /// The scene is right; where light passes its lens is searched, which takes seconds behind a drawing as aperture.
    Preparing,
    /// Nothing is wrong: light is traced from now on.
    Ready,
    /// What a person should know before believing the picture.
    Warning(&'a Warning),
    /// What is worth knowing of how the scene is taken.
    Note(&'a str),
    /// A remark on a series, in words and as data.
    Series(&'a str, &'a Value),
    /// From now on it is this one of several pictures, or none any more.
    Picture(Option<Place>),
    /// The light of a scene is traced.
    Start(&'a Scene),
    /// No more light is traced.
    Traced,
    /// These files are complete.
    Written(&'a [String]),
    /// A picture is done.
    Done {
        /// How it came about.
        report: &'a Report<'a>,
        /// Whether somebody stopped it.
        stopped: bool,
    },
}

/// Where files go, and may be already.
pub trait Folder: Sink {
    /// Sees to it that such files can be written; `name` is that of the scene.
    ///
    /// # Errors
    /// Why not, in words.
    fn prepare(&self, name: &str, files: &[&str]) -> Result<(), String>;

    /// Whether a file is there, and not empty.
    fn has(&self, file: &str) -> bool;

    /// Whether a file is the one at this path on disk, if it is there.
    fn is(&self, _file: &str, _path: &Path) -> bool {
        false
    }

    /// The content of a file that is there and not larger than `most` bytes.
    fn read(&self, file: &str, most: u64) -> Option<Vec<u8>>;

    /// How a file is named to a person.
    fn shown(&self, file: &str) -> String;
}

/// A program that has pictures rendered.
pub trait Host: Sync {
    /// Its threads.
    fn workers(&self) -> &dyn Workers;

    /// How many they are, for the record.
    fn threads(&self) -> usize;

    /// What stops the next picture.
    fn control(&self) -> Arc<Control>;

    /// Whether somebody asked for an end.
    fn is_interrupted(&self) -> bool;

    /// Whether no picture is to be begun any more: somebody asked for an end, or the time is up.
    fn is_stopped(&self) -> bool;

    /// Seconds since any moment.
    fn now_s(&self) -> f64;

    /// Bytes of memory that can still be had, where that is known.
    fn memory_bytes(&self) -> Option<u64>;

    /// Where results go.
    fn folder(&self) -> &dyn Folder;

    /// Where light is kept that could not go there.
    fn elsewhere(&self) -> &dyn Folder;

    /// Hears what goes on, from any thread.
    fn hear(&self, event: Event<'_>);
}
