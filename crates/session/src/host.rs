//! The interface that a program implements to run sessions: workers, folders, and events that it hears.
//!
//! The engine owns no threads, clock or disk. A program lends it threads ([`Workers`]), a [`Control`] that can stop it, a [`Sink`] that
//! takes files by name, and for a whole job a [`Host`]. `spectra run` is such a host. Without threads, disk and clock (`Alone`, `Memory`) a
//! render has the same bits.

use crate::{Control, Report, Workers};
use serde_json::Value;
use spectra_core::params::{Fault, Warning};
use spectra_core::sink::Sink;
use spectra_scene::Scene;
use std::path::Path;
use std::sync::Arc;

/// Position of a picture among several.
#[derive(Clone, Copy, Debug)]
pub struct SeriesPosition {
    /// Number of the picture in the sweep, or number of the frame.
    pub number: u32,
    /// Number of pictures that come before it.
    pub index: usize,
    /// Number of pictures in all.
    pub of: usize,
}

/// Progress and results of a job, as they happen.
#[derive(Clone, Copy)]
pub enum Event<'a> {
    /// Some pictures of a series have been checked.
    Checked {
        /// Number of pictures checked so far.
        done: usize,
        /// Number of pictures in all.
        of: usize,
    },
    /// The scene has no faults. The search for where light passes the lens begins, which takes seconds if the aperture is a
    /// drawing.
    Preparing,
    /// All checks have passed; tracing comes next.
    Ready,
    /// A warning to consider before trusting the picture.
    Warning(&'a Warning),
    /// A note on how the scene is taken.
    Note(&'a str),
    /// A remark on a series, as text and as data.
    Series(&'a str, &'a Value),
    /// The picture of a series that the following events are about; `None` after the last one.
    Picture(Option<SeriesPosition>),
    /// Tracing of a scene has begun.
    Start(&'a Scene),
    /// Every pixel has its first sample of all light.
    FirstPass,
    /// There is a time limit, and the picture after its first pass is developed. From now on there is a picture to write, and another one
    /// will take about as many seconds.
    DevelopedOnce {
        /// Time of the development, s.
        seconds: f64,
    },
    /// These files hold the picture so far.
    Snapshot(&'a [String]),
    /// Tracing of the scene has ended.
    Traced,
    /// These files are complete.
    Written(&'a [String]),
    /// A picture is finished.
    Done {
        /// Report on how the picture was made.
        report: &'a Report<'a>,
        /// Whether the user stopped it.
        stopped: bool,
    },
}

/// A folder for results, which may already hold files.
pub trait Folder: Sink {
    /// Makes sure that files of these names can be written. `name` is the name of the scene.
    ///
    /// # Errors
    /// The reason why they cannot.
    fn prepare(&self, name: &str, files: &[&str]) -> Result<(), Fault>;

    /// Returns whether a file exists and is not empty.
    fn has(&self, file: &str) -> bool;

    /// Returns whether a file exists and is the same as the one at this path on disk.
    fn is(&self, _file: &str, _path: &Path) -> bool {
        false
    }

    /// Returns whether both files exist and the first was changed after the second.
    fn is_newer(&self, _file: &str, _than: &str) -> bool {
        false
    }

    /// Removes a file if it exists.
    fn remove(&self, _file: &str) {}

    /// Returns the content of a file if it exists and has at most `most` bytes.
    fn read(&self, file: &str, most: u64) -> Option<Vec<u8>>;

    /// Returns the name of a file as shown to the user.
    fn shown(&self, file: &str) -> String;
}

/// A program that has pictures rendered.
pub trait Host: Sync {
    /// The threads of the program.
    fn workers(&self) -> &dyn Workers;

    /// Number of threads, for the record.
    fn threads(&self) -> usize;

    /// Returns the control that can stop the next picture.
    fn control(&self) -> Arc<Control>;

    /// Returns whether the user asked to stop.
    fn is_interrupted(&self) -> bool;

    /// Returns whether no further picture may begin: the user asked to stop, or the time limit is reached.
    fn is_stopped(&self) -> bool;

    /// Returns the time in seconds since the program started.
    fn now_s(&self) -> f64;

    /// Returns the time, as [`Host::now_s`] counts it, at which everything should be done, if the user limits it. The host stops the
    /// control of a picture early enough for development.
    fn time_limit_s(&self) -> Option<f64> {
        None
    }

    /// Bytes of memory that are still available, if known.
    fn memory_bytes(&self) -> Option<u64>;

    /// The folder for results.
    fn folder(&self) -> &dyn Folder;

    /// The folder for light that could not be saved in [`Host::folder`].
    fn elsewhere(&self) -> &dyn Folder;

    /// Receives an event, from any thread.
    fn hear(&self, event: Event<'_>);
}
