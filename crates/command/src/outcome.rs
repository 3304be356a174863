//! How a command ends.

use crate::console;
use spectra_core::params::{Fault, Faults};
use spectra_files::WriteError;
use spectra_session::SessionError;
use std::io;

/// Done, or stopped when its time was up.
pub(crate) const DONE: u8 = 0;
/// Something failed on the way.
pub(crate) const FAILED: u8 = 1;
/// The input is wrong.
pub(crate) const BAD_INPUT: u8 = 2;

/// An exit code, or why the command could not do what it should.
pub(crate) type Outcome = Result<u8, Failure>;

/// Why a command could not do what it should.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Everything wrong with the files given.
    Faults(Faults),
    /// An argument or a table is wrong.
    Input(String),
    /// The system refused something, or the render failed.
    Failed(String),
    /// Whoever read standard output has enough: `spectra list | head -1`.
    ReaderGone,
}

impl Failure {
    /// Says so on standard error; returns the exit code.
    pub(crate) fn report(&self) -> u8 {
        match self {
            Self::Faults(faults) => console::faults(faults),
            Self::Input(text) | Self::Failed(text) => console::error(text),
            Self::ReaderGone => {}
        }
        self.code()
    }

    /// The exit code.
    pub(crate) fn code(&self) -> u8 {
        match self {
            Self::Faults(_) | Self::Input(_) => BAD_INPUT,
            Self::Failed(_) => FAILED,
            Self::ReaderGone => DONE,
        }
    }
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

/// Standard output that cannot be written.
impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::ReaderGone,
            _ => Self::Failed(format!("standard output cannot be written: {error}")),
        }
    }
}
