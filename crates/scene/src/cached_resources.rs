//! A cache of files, so that each is read once.

use spectra_core::params::{Faults, Params};
use spectra_core::resources::{FoundFile, Resource, ResourceError, Resources};
use std::collections::{BTreeSet, HashMap};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// A request: path, folders, endings.
type Key = (String, Vec<String>, Vec<String>);

/// Caches every file that stages read whole, so that a scene that is changed and assembled again reads none twice. Large files,
/// of which stages read only parts, are not kept.
pub(crate) struct CachedResources {
    inner: Arc<dyn Resources>,
    files: Mutex<HashMap<Key, Resource>>,
    documents: Mutex<HashMap<Key, Params>>,
    /// Names of all files that were requested and exist, as shown in messages.
    names: Mutex<BTreeSet<String>>,
}

/// Prefix of the names of bundled files.
pub(crate) const BUNDLED: &str = "bundled:";

fn key(path: &str, folders: &[&str], endings: &[&str]) -> Key {
    let owned = |all: &[&str]| all.iter().map(|s| (*s).to_owned()).collect();
    (path.to_owned(), owned(folders), owned(endings))
}

/// Returns the cached value, or calls `read` and caches its result.
fn once<T: Clone, E>(known: &Mutex<HashMap<Key, T>>, key: Key, read: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
    let found = known.lock().unwrap_or_else(PoisonError::into_inner).get(&key).cloned();
    match found {
        Some(found) => Ok(found),
        None => read().inspect(|read| {
            known.lock().unwrap_or_else(PoisonError::into_inner).insert(key, read.clone());
        }),
    }
}

impl CachedResources {
    pub(crate) fn new(inner: Arc<dyn Resources>) -> Self {
        Self { inner, files: Mutex::default(), documents: Mutex::default(), names: Mutex::default() }
    }

    /// Returns the files on disk among those requested so far.
    pub(crate) fn on_disk(&self) -> Vec<PathBuf> {
        let names = self.names.lock().unwrap_or_else(PoisonError::into_inner);
        names.iter().filter(|name| !name.starts_with(BUNDLED)).map(PathBuf::from).collect()
    }

    fn note(&self, name: &str) {
        self.names.lock().unwrap_or_else(PoisonError::into_inner).insert(name.to_owned());
    }
}

impl Resources for CachedResources {
    fn read(&self, path: &str, folders: &[&str], endings: &[&str], limit: u64) -> Result<Resource, ResourceError> {
        let read = once(&self.files, key(path, folders, endings), || self.inner.read(path, folders, endings, limit))?;
        self.note(&read.name);
        let size = read.bytes.len() as u64;
        if size > limit { Err(ResourceError::TooLarge(size, limit)) } else { Ok(read) }
    }

    fn find(&self, path: &str, folders: &[&str], endings: &[&str], limit: u64) -> Result<FoundFile, ResourceError> {
        self.inner.find(path, folders, endings, limit).inspect(|found| self.note(&found.name))
    }

    fn document(&self, path: &str, folders: &[&str], endings: &[&str]) -> Result<Params, Faults> {
        let read = || self.inner.document(path, folders, endings);
        once(&self.documents, key(path, folders, endings), read).inspect(|read| self.note(&read.node().file.name))
    }
}
