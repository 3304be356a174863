//! Unpacking of the archive to a folder, once.

use crate::{ARCHIVE, VERSION};
use flate2::read::ZlibDecoder;
use std::fs;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// Files to write beside the packed ones: path below the root with forward slashes, and content.
pub type Data<'a> = dyn Iterator<Item = (&'static str, &'static [u8])> + 'a;

/// Unpacks the sources and `data` into a folder of `cache` that is named after their version and content, unless it exists
/// already. Returns that folder. Files are written under a temporary folder name, and the folder gets its own name when it is
/// complete. Two processes may therefore do this at once, and one that is killed leaves nothing that looks complete.
///
/// # Errors
/// The program holds no sources ([`crate::is_empty`]), or the folder cannot be written.
pub fn unpack(cache: &Path, data: &mut Data<'_>) -> io::Result<PathBuf> {
    if crate::is_empty() {
        return Err(io::Error::new(io::ErrorKind::NotFound, "this program was built without its sources"));
    }
    let data: Vec<(&str, &[u8])> = data.collect();
    let folder = cache.join(format!("sources-{VERSION}-{:016x}", identity(&data)));
    if folder.is_dir() {
        return Ok(folder);
    }
    fs::create_dir_all(cache)?;
    remove_abandoned(cache);
    let temporary = cache.join(temporary_name());
    let written = write(&temporary, &data).and_then(|()| fs::rename(&temporary, &folder));
    if let Err(error) = written {
        // Removes the incomplete folder; a failure of the removal is ignored.
        let _ = fs::remove_dir_all(&temporary);
        // Another process may have been faster.
        return if folder.is_dir() { Ok(folder) } else { Err(error) };
    }
    Ok(folder)
}

/// Returns a hash that identifies the sources and data: FNV-1a over names and contents.
fn identity(data: &[(&str, &[u8])]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |bytes: &[u8]| {
        for byte in (bytes.len() as u64).to_le_bytes().iter().chain(bytes) {
            hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    add(ARCHIVE);
    for (name, bytes) in data {
        add(name.as_bytes());
        add(bytes);
    }
    hash
}

const TEMPORARY: &str = ".unpacking-";

/// Returns a name that no other process or thread uses.
fn temporary_name() -> String {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    format!("{TEMPORARY}{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed))
}

/// Removes what processes that were killed have left, if it is older than a day.
fn remove_abandoned(cache: &Path) {
    const DAY: std::time::Duration = std::time::Duration::from_secs(24 * 3600);
    for entry in fs::read_dir(cache).into_iter().flatten().flatten() {
        let age = entry.metadata().and_then(|m| m.modified()).ok().and_then(|time| time.elapsed().ok());
        if entry.file_name().to_string_lossy().starts_with(TEMPORARY) && age.is_some_and(|age| age > DAY) {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

fn write(folder: &Path, data: &[(&str, &[u8])]) -> io::Result<()> {
    let mut archive = tar::Archive::new(ZlibDecoder::new(ARCHIVE));
    for entry in archive.entries()? {
        let mut entry = entry?;
        let path = entry.path()?.into_owned();
        let mut bytes = Vec::with_capacity(entry.size() as usize);
        entry.read_to_end(&mut bytes)?;
        write_file(folder, &path, &bytes)?;
    }
    for (name, bytes) in data {
        write_file(folder, Path::new(name), bytes)?;
    }
    Ok(())
}

fn write_file(folder: &Path, name: &Path, bytes: &[u8]) -> io::Result<()> {
    if !name.components().all(|c| matches!(c, Component::Normal(_))) {
        return Err(io::Error::other(format!("{} leads out of the folder", name.display())));
    }
    let path = folder.join(name);
    fs::create_dir_all(path.parent().unwrap_or(folder))?;
    fs::write(path, bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn data() -> impl Iterator<Item = (&'static str, &'static [u8])> {
        [("spectra/a/b.csv", &b"1,2\n"[..]), ("lenses/c.yaml", b"name: c\n")].into_iter()
    }

    /// Returns the paths of all files below a folder, with forward slashes.
    fn files(folder: &Path) -> BTreeSet<String> {
        let mut found = BTreeSet::new();
        let mut open = vec![folder.to_owned()];
        while let Some(next) = open.pop() {
            for entry in fs::read_dir(&next).unwrap().flatten() {
                if entry.path().is_dir() {
                    open.push(entry.path());
                } else {
                    let path = entry.path();
                    let inside = path.strip_prefix(folder).unwrap();
                    found.insert(inside.to_string_lossy().replace('\\', "/"));
                }
            }
        }
        found
    }

    #[test]
    fn sources_come_back_whole() {
        let cache = tempfile::tempdir().unwrap();
        let folder = unpack(cache.path(), &mut data()).unwrap();
        let name = folder.file_name().unwrap().to_str().unwrap().to_owned();
        assert!(name.starts_with(&format!("sources-{VERSION}-")), "{name}");
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let unpacked = files(&folder);
        for expected in ["Cargo.lock", "src/main.rs", "crates/workspace/src/unpack.rs", "crates/workspace/build.rs"] {
            assert_eq!(fs::read(folder.join(expected)).unwrap(), fs::read(root.join(expected)).unwrap(), "{expected}");
        }
        assert_eq!(fs::read(folder.join("spectra/a/b.csv")).unwrap(), b"1,2\n");
        for name in &unpacked {
            let hidden = name.split('/').any(|part| part.starts_with('.'));
            assert!(!hidden && !name.ends_with('~') && !name.contains("/target/"), "{name}");
            let crate_folder = name.split('/').take(2).collect::<Vec<_>>().join("/");
            assert!(!name.starts_with(&format!("{crate_folder}/tests/")), "{name}");
        }
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        assert!(!manifest.contains("[[bench]]") && manifest.contains("[profile.release]"), "{manifest}");
        // The cache holds nothing else, and a second call writes nothing.
        assert_eq!(fs::read_dir(cache.path()).unwrap().count(), 1);
        fs::write(folder.join("mark"), "").unwrap();
        assert_eq!(unpack(cache.path(), &mut data()).unwrap(), folder);
        assert!(folder.join("mark").is_file());
    }

    #[test]
    fn other_data_is_another_folder() {
        let cache = tempfile::tempdir().unwrap();
        let a = unpack(cache.path(), &mut data()).unwrap();
        let b = unpack(cache.path(), &mut data().take(1)).unwrap();
        assert_ne!(a, b);
    }

    #[test]
    fn eight_at_once_agree() {
        let cache = tempfile::tempdir().unwrap();
        let folders: Vec<PathBuf> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..8).map(|_| scope.spawn(|| unpack(cache.path(), &mut data()).unwrap())).collect();
            threads.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        assert!(folders.iter().all(|folder| *folder == folders[0]));
        assert_eq!(fs::read_dir(cache.path()).unwrap().count(), 1, "temporary folders are left");
        assert!(folders[0].join("crates/core/src/lib.rs").is_file());
    }

    #[test]
    fn what_cannot_be_written_is_said() {
        let cache = tempfile::tempdir().unwrap();
        let file = cache.path().join("file");
        fs::write(&file, "").unwrap();
        assert!(unpack(&file, &mut data()).is_err());
        let outside = [("../outside", &b""[..])];
        assert!(unpack(cache.path(), &mut outside.into_iter()).is_err());
        assert_eq!(fs::read_dir(cache.path()).unwrap().count(), 1, "half of it is left");
    }
}
