//! Destinations of results: a folder, an archive, memory.

use std::io::{Cursor, Read, Seek, Write};
use std::sync::{Mutex, PoisonError};

/// A destination that a file is written to. It can seek and read, because some formats return to their headers and read back
/// what they wrote.
pub trait Out: Read + Write + Seek {}

impl<T: Read + Write + Seek> Out for T {}

/// Error that occurred while the content of a file was written.
#[derive(Debug)]
pub enum WriteFault {
    /// Error of the operating system.
    Io(std::io::Error),
    /// Reason why the format cannot hold the content.
    Format(String),
}

impl From<std::io::Error> for WriteFault {
    fn from(cause: std::io::Error) -> Self {
        Self::Io(cause)
    }
}

impl std::fmt::Display for WriteFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Io(cause) => cause.fmt(f),
            Self::Format(cause) => f.write_str(cause),
        }
    }
}

/// Callback that writes the content of a file.
pub type Content<'a> = &'a mut dyn FnMut(&mut dyn Out) -> Result<(), WriteFault>;

/// A destination for files with names: a folder, an archive, memory. Each file is stored whole or not at all.
pub trait Sink: Sync {
    /// Stores one file under `name`.
    ///
    /// # Errors
    /// The error of `content`, or of the destination.
    fn file(&self, name: &str, content: Content<'_>) -> Result<(), WriteFault>;
}

/// Files kept in memory, in the order in which they were stored.
#[derive(Debug, Default)]
pub struct Memory(Mutex<Vec<(String, Vec<u8>)>>);

impl Memory {
    /// Returns the names and contents of the files.
    #[must_use]
    pub fn into_files(self) -> Vec<(String, Vec<u8>)> {
        self.0.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Sink for Memory {
    fn file(&self, name: &str, content: Content<'_>) -> Result<(), WriteFault> {
        let mut bytes = Cursor::new(Vec::new());
        content(&mut bytes)?;
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push((name.to_owned(), bytes.into_inner()));
        Ok(())
    }
}
