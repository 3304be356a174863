//! Where results go.

use std::io::{Cursor, Read, Seek, Write};
use std::sync::{Mutex, PoisonError};

/// What a file is written into. Formats come back to their heads, and read what they wrote.
pub trait Out: Read + Write + Seek {}

impl<T: Read + Write + Seek> Out for T {}

/// What went wrong while the content of a file was written.
#[derive(Debug)]
pub enum WriteFault {
    /// The system refused.
    Io(std::io::Error),
    /// Why the format cannot hold the content.
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

/// Writes the content of a file.
pub type Content<'a> = &'a mut dyn FnMut(&mut dyn Out) -> Result<(), WriteFault>;

/// Takes files by their names: a folder, an archive, memory. Each is there whole or not at all.
pub trait Sink: Sync {
    /// Takes one file.
    ///
    /// # Errors
    /// What `content` has, or the place that the files go to.
    fn file(&self, name: &str, content: Content<'_>) -> Result<(), WriteFault>;
}

/// Files in memory, in the order in which they came.
#[derive(Debug, Default)]
pub struct Memory(Mutex<Vec<(String, Vec<u8>)>>);

impl Memory {
    /// The files with their names.
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
