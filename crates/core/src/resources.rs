//! Files that a stage asks for by name: looked up beside the scene first, then among the bundled data.

use crate::params::{Faults, Node, Params};
use std::borrow::Cow;
use std::io::{BufRead, BufReader, Cursor, Read, Seek};
use std::path::{Path, PathBuf};

/// What went wrong with a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ResourceError {
    /// No such file, neither beside the scene nor bundled; holds similar names.
    NotFound(Vec<String>),
    /// It is larger than the caller's limit, bytes: (found, limit).
    TooLarge(u64, u64),
    /// The operating system's error.
    Io(String),
}

impl std::fmt::Display for ResourceError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotFound(_) => write!(f, "no such file"),
            Self::TooLarge(found, limit) => write!(f, "{found} bytes; at most {limit} are read"),
            Self::Io(text) => f.write_str(text),
        }
    }
}

impl std::error::Error for ResourceError {}

/// A file that was found.
#[derive(Clone, Debug)]
pub struct Resource {
    /// Its name in messages: a path, or `bundled:...`.
    pub name: String,
    /// Its folder on disk, against which paths inside it are resolved; `None` when bundled.
    pub folder: Option<PathBuf>,
    /// The content.
    pub bytes: Cow<'static, [u8]>,
}

/// A file that was found and not read.
#[derive(Clone, Debug)]
pub struct Found {
    /// How to name it to a person: a path, or `bundled:...`.
    pub name: String,
    content: Content,
}

#[derive(Clone, Debug)]
enum Content {
    OnDisk(PathBuf),
    Bytes(Cow<'static, [u8]>),
}

/// What a decoder reads from.
pub trait ReadSeek: BufRead + Seek + Send {}

impl<R: BufRead + Seek + Send> ReadSeek for R {}

impl Found {
    /// A file on disk.
    #[must_use]
    pub fn on_disk(name: String, path: PathBuf) -> Self {
        Self { name, content: Content::OnDisk(path) }
    }

    /// Bytes that are there already.
    #[must_use]
    pub fn bytes(name: String, bytes: Cow<'static, [u8]>) -> Self {
        Self { name, content: Content::Bytes(bytes) }
    }

    /// Where it lies on disk; `None` of bytes that are there already.
    #[must_use]
    pub fn path(&self) -> Option<&Path> {
        match &self.content {
            Content::OnDisk(path) => Some(path),
            Content::Bytes(_) => None,
        }
    }

    /// Its size, bytes.
    ///
    /// # Errors
    /// [`ResourceError::Io`].
    pub fn size_bytes(&self) -> Result<u64, ResourceError> {
        match &self.content {
            Content::OnDisk(path) => std::fs::metadata(path).map(|data| data.len()).map_err(io),
            Content::Bytes(bytes) => Ok(bytes.len() as u64),
        }
    }

    /// For reading parts of it.
    ///
    /// # Errors
    /// [`ResourceError::Io`].
    pub fn open(&self) -> Result<Box<dyn ReadSeek + '_>, ResourceError> {
        Ok(match &self.content {
            Content::OnDisk(path) => Box::new(BufReader::new(std::fs::File::open(path).map_err(io)?)),
            Content::Bytes(bytes) => Box::new(Cursor::new(&**bytes)),
        })
    }

    /// All of it, or as much of its start.
    ///
    /// # Errors
    /// [`ResourceError::Io`].
    pub fn read(&self, at_most_bytes: u64) -> Result<Vec<u8>, ResourceError> {
        let mut bytes = Vec::with_capacity(self.size_bytes()?.min(at_most_bytes) as usize);
        self.open()?.take(at_most_bytes).read_to_end(&mut bytes).map_err(io)?;
        Ok(bytes)
    }
}

fn io(error: std::io::Error) -> ResourceError {
    ResourceError::Io(error.to_string())
}

/// Finds files for stages.
pub trait Resources: Send + Sync {
    /// Reads `path`: as given relative to the scene's folder, else bundled under one of `folders`
    /// (such as `lenses`), with each of `endings` (such as `.yaml`) tried too.
    ///
    /// # Errors
    /// [`ResourceError`].
    fn read(&self, path: &str, folders: &[&str], endings: &[&str], limit_bytes: u64)
    -> Result<Resource, ResourceError>;

    /// Finds a file as [`Resources::read`] does, without reading it: for large ones.
    ///
    /// # Errors
    /// [`ResourceError`].
    fn find(&self, path: &str, folders: &[&str], endings: &[&str], limit_bytes: u64) -> Result<Found, ResourceError> {
        self.read(path, folders, endings, limit_bytes).map(|read| Found::bytes(read.name, read.bytes))
    }

    /// Reads and parses a YAML document (a lens, a film stock), found as by [`Resources::read`].
    ///
    /// # Errors
    /// What is wrong with the file or its syntax, with the place in that file. If the file itself is not found the fault has
    /// no place: attach it to the key that named the file.
    fn document(&self, path: &str, folders: &[&str], endings: &[&str]) -> Result<Params, Faults>;
}

/// The path to give to [`Resources::read`] for a file that the value `node` names: relative to the file in which the value is
/// written, if that is on disk; else as written, which is relative to the scene.
#[must_use]
pub fn beside(node: &Node, path: &str) -> String {
    let there = node.file.folder().map(|folder| folder.join(path)).filter(|there| there.is_file());
    let absolute = there.and_then(|there| std::path::absolute(there).ok());
    absolute.and_then(|there| there.into_os_string().into_string().ok()).unwrap_or_else(|| path.to_owned())
}
