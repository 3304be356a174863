//! Files that a stage asks for by name: looked up beside the scene first, then among the bundled data.

use crate::params::{Faults, Node, Params};
use std::borrow::Cow;
use std::io::{BufRead, BufReader, Cursor, Read, Seek};
use std::path::{Path, PathBuf};

/// Error of finding or reading a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ResourceError {
    /// There is no such file, neither beside the scene nor bundled; holds similar names.
    NotFound(Vec<String>),
    /// The file is larger than the caller's limit: (found, limit), bytes.
    TooLarge(u64, u64),
    /// Error of the operating system.
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

/// A file that was found and read.
#[derive(Clone, Debug)]
pub struct Resource {
    /// Name of the file in messages: a path, or `bundled:...`.
    pub name: String,
    /// Folder of the file on disk, against which paths inside the file are resolved; `None` if bundled.
    pub folder: Option<PathBuf>,
    /// Content of the file.
    pub bytes: Cow<'static, [u8]>,
}

/// A file that was found but not read.
#[derive(Clone, Debug)]
pub struct FoundFile {
    /// Name of the file in messages: a path, or `bundled:...`.
    pub name: String,
    content: Content,
}

#[derive(Clone, Debug)]
enum Content {
    OnDisk(PathBuf),
    Bytes(Cow<'static, [u8]>),
}

/// A seekable reader, as decoders need it.
pub trait ReadSeek: BufRead + Seek + Send {}

impl<R: BufRead + Seek + Send> ReadSeek for R {}

impl FoundFile {
    /// Creates a reference to a file on disk.
    #[must_use]
    pub fn on_disk(name: String, path: PathBuf) -> Self {
        Self { name, content: Content::OnDisk(path) }
    }

    /// Creates a file from bytes in memory.
    #[must_use]
    pub fn bytes(name: String, bytes: Cow<'static, [u8]>) -> Self {
        Self { name, content: Content::Bytes(bytes) }
    }

    /// Path of the file on disk; `None` for bytes in memory.
    #[must_use]
    pub fn path(&self) -> Option<&Path> {
        match &self.content {
            Content::OnDisk(path) => Some(path),
            Content::Bytes(_) => None,
        }
    }

    /// Size of the file, bytes.
    ///
    /// # Errors
    /// [`ResourceError::Io`].
    pub fn size_bytes(&self) -> Result<u64, ResourceError> {
        match &self.content {
            Content::OnDisk(path) => std::fs::metadata(path).map(|data| data.len()).map_err(io),
            Content::Bytes(bytes) => Ok(bytes.len() as u64),
        }
    }

    /// Opens the file for reading parts of it.
    ///
    /// # Errors
    /// [`ResourceError::Io`].
    pub fn open(&self) -> Result<Box<dyn ReadSeek + '_>, ResourceError> {
        Ok(match &self.content {
            Content::OnDisk(path) => Box::new(BufReader::new(std::fs::File::open(path).map_err(io)?)),
            Content::Bytes(bytes) => Box::new(Cursor::new(&**bytes)),
        })
    }

    /// Reads the file from its start, at most `at_most_bytes` bytes of it.
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

/// Access to the files that stages ask for.
pub trait Resources: Send + Sync {
    /// Reads the file `path`, which is relative to the scene's folder. If there is none, looks for a bundled file under each of
    /// `folders` (such as `lenses`). The name is tried as given and with each of `endings` (such as `.yaml`).
    ///
    /// # Errors
    /// [`ResourceError`].
    fn read(&self, path: &str, folders: &[&str], endings: &[&str], limit_bytes: u64)
    -> Result<Resource, ResourceError>;

    /// Finds a file like [`Resources::read`], without reading it; for large files.
    ///
    /// # Errors
    /// [`ResourceError`].
    fn find(
        &self,
        path: &str,
        folders: &[&str],
        endings: &[&str],
        limit_bytes: u64,
    ) -> Result<FoundFile, ResourceError> {
        self.read(path, folders, endings, limit_bytes).map(|read| FoundFile::bytes(read.name, read.bytes))
    }

    /// Reads and parses a YAML document (a lens, a film stock), found as by [`Resources::read`].
    ///
    /// # Errors
    /// The faults of the file or its syntax, with the place in that file. If the file itself is not found, the fault has no
    /// place: attach it to the key that named the file.
    fn document(&self, path: &str, folders: &[&str], endings: &[&str]) -> Result<Params, Faults>;
}

/// Returns the path to pass to [`Resources::read`] for a file that the value `node` names. If that file exists relative to the
/// file in which the value is written, the result is its absolute path. Otherwise it is the path as written, which is relative
/// to the scene.
#[must_use]
pub fn beside(node: &Node, path: &str) -> String {
    let there = node.file.folder().map(|folder| folder.join(path)).filter(|there| there.is_file());
    let absolute = there.and_then(|there| std::path::absolute(there).ok());
    absolute.and_then(|there| there.into_os_string().into_string().ok()).unwrap_or_else(|| path.to_owned())
}
