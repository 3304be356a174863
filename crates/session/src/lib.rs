//! Sessions: renders that a program holds, changes and continues.
//!
//! A [`Session`] holds one picture of a scene. Open it from a path or a series; trace some samples and look at the result.
//! Change a value and continue with all results that the change leaves valid. Save the light and load it again, develop it, and
//! write it to files. [`run()`] does all of that for every picture of a scene, as `spectra run` does.
//!
//! A session has no thread, clock, terminal or disk of its own. A program lends it workers, tells it when to stop, and takes its
//! files. Warnings, notes and results come back as values.
//!
//! ```no_run
//! use spectra_session::{Control, Session, SessionOptions, SingleThread};
//! # fn main() -> Result<(), spectra_session::SessionError> {
//! let mut session = Session::open("scene.yaml".as_ref(), &[], SessionOptions::default())?;
//! session.step(16, &SingleThread, &Control::new())?;
//! let picture = session.develop()?.remove(0).1;
//! let kept = session.change("film.exposure=1/250 s")?;
//! assert!(kept.light);
//! # Ok(())
//! # }
//! ```

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod check;
mod contact;
mod develop;
mod error;
mod exposure_backup;
mod exposure_warnings;
mod files;
mod first_frame;
pub mod formatting;
mod header;
mod host;
mod job;
mod names;
mod options;
mod pace;
mod picture_files;
mod report;
mod run;
mod series;
mod session;
mod summary;
mod threads;
mod time_limit;
mod traced_picture;

pub use check::{CheckSettings, Checked, check};
pub use develop::{Develop, develop, picture_ending};
pub use error::SessionError;
pub use header::films;
pub use host::{Event, Folder, Host, SeriesPosition};
pub use job::{Job, JobEnd};
pub use names::Names;
pub use options::SessionOptions;
pub use pace::Pace;
pub use report::Report;
pub use run::run;
pub use session::{Session, Snapshot, ValidResults};
pub use spectra_darkroom::LightFrom;
pub use spectra_render::{Control, Effort, Rendering, SingleThread, Threads, Workers};
pub use spectra_scene::Developed;
pub use threads::make_threads;
pub use time_limit::TimeSpent;
