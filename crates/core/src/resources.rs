//! Files that a stage asks for by name: looked up beside the scene first, then among the bundled data.

use crate::params::{Faults, Node, Params};
use std::borrow::Cow;
use std::path::PathBuf;

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

/// Finds files for stages.
pub trait Resources: Send + Sync {
    /// Reads `path`: as given relative to the scene's folder, else bundled under one of `folders`
    /// (such as `lenses`), with each of `endings` (such as `.yaml`) tried too.
    ///
    /// # Errors
    /// [`ResourceError`].
    fn read(&self, path: &str, folders: &[&str], endings: &[&str], limit_bytes: u64)
    -> Result<Resource, ResourceError>;

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
