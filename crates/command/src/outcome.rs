//! Exit codes and errors of commands.

use crate::console;
use serde_json::json;
use spectra_core::params::{Fault, Faults};
use spectra_files::WriteError;
use spectra_plot::PlotError;
use spectra_scene::diagnostics;
use spectra_session::SessionError;
use std::io;

/// Exit code of success, or of a render stopped by its time limit.
pub(crate) const DONE: u8 = 0;
/// Exit code of a failure along the way, such as a full disk.
pub(crate) const FAILED: u8 = 1;
/// Exit code of wrong input.
pub(crate) const BAD_INPUT: u8 = 2;

/// Result of a command: its exit code, or the reason it failed.
pub(crate) type Outcome = Result<u8, Failure>;

/// Reason why a command failed.
#[derive(Debug)]
pub(crate) enum Failure {
    /// All faults of the given files.
    Faults(Faults),
    /// An argument or a table is wrong.
    Input(String),
    /// The system refused something, or the render failed.
    Failed(String),
    /// The reader of standard output has closed it, as in `spectra list | head -1`. This is not an error.
    ReaderGone,
}

impl Failure {
    /// Returns the failure of a command whose stage failed.
    pub(crate) fn of_stage(fault: Fault) -> Self {
        Self::Failed(fault.to_string())
    }

    /// Reports the failure on standard error; returns the exit code.
    pub(crate) fn report(&self) -> u8 {
        match self {
            Self::Faults(faults) => console::faults(faults),
            Self::Input(text) | Self::Failed(text) => console::error(text),
            Self::ReaderGone => {}
        }
        self.code()
    }

    /// Exit code of this failure.
    pub(crate) fn code(&self) -> u8 {
        match self {
            Self::Faults(_) | Self::Input(_) => BAD_INPUT,
            Self::Failed(_) => FAILED,
            Self::ReaderGone => DONE,
        }
    }
}

/// Writes a failure as a JSON event if `is_json`; returns the outcome unchanged.
pub(crate) fn with_json_error(outcome: Outcome, is_json: bool) -> Outcome {
    if let (true, Err(failure)) = (is_json, &outcome) {
        let event = match failure {
            Failure::Faults(faults) => {
                json!({ "event": "error", "message": faults.to_string(), "faults": diagnostics::to_json(faults) })
            }
            Failure::Input(text) | Failure::Failed(text) => json!({ "event": "error", "message": text, "faults": [] }),
            Failure::ReaderGone => return outcome,
        };
        // If the reader has gone away, only the event is lost.
        let _ = console::json(&event);
    }
    outcome
}

impl From<Faults> for Failure {
    fn from(faults: Faults) -> Self {
        Self::Faults(faults)
    }
}

impl From<Fault> for Failure {
    fn from(fault: Fault) -> Self {
        Self::Faults(fault.into())
    }
}

impl From<SessionError> for Failure {
    fn from(error: SessionError) -> Self {
        match error {
            SessionError::Faults(faults) => Self::Faults(faults),
            SessionError::Request(text) => Self::Input(text),
            other => Self::Failed(other.to_string()),
        }
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        Self::Failed(error.to_string())
    }
}

/// Converts an error of writing a figure. An unknown extension is wrong input.
impl From<PlotError> for Failure {
    fn from(error: PlotError) -> Self {
        match error {
            PlotError::Ending { .. } => Self::Input(error.to_string()),
            PlotError::Write(error) => error.into(),
        }
    }
}

/// Converts an error of standard output. A closed pipe becomes [`Failure::ReaderGone`].
impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::ReaderGone,
            _ => Self::Failed(format!("standard output cannot be written: {error}")),
        }
    }
}
