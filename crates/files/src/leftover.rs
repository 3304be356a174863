//! Cleanup of leftover temporary files `.NAME.PROCESS-NUMBER.tmp`, see [`super::write_atomically`].

use std::fs::{File, TryLockError};
use std::path::Path;
use std::time::{Duration, SystemTime};

/// Age from which nobody is expected to write a file any more.
const OLD: Duration = Duration::from_secs(600);

/// Removes the temporary files that this process was writing in `folder`.
pub fn remove_own(folder: &Path) {
    remove(folder, |name, _| process_of(name) == Some(std::process::id()));
}

/// Removes temporary files that killed runs have left in `folder`. A file is removed if its name is that of a temporary file, its
/// process no longer runs, and nobody has it locked.
pub fn remove_stale_temporaries(folder: &Path) {
    remove(folder, |name, modified| {
        if process_of(name).is_none_or(is_alive) {
            return false;
        }
        match is_locked(&folder.join(name)) {
            Some(is_held) => !is_held,
            // A file system without locks: the age of the file decides.
            None => SystemTime::now().duration_since(modified).is_ok_and(|age| age > OLD),
        }
    });
}

/// Returns whether a writer holds the file; `None` if that is not known. Inside a container the writer's process may have another
/// number.
fn is_locked(path: &Path) -> Option<bool> {
    if !super::atomically::HOLDS {
        return None;
    }
    match File::open(path).ok()?.try_lock() {
        Ok(()) => Some(false),
        Err(TryLockError::WouldBlock) => Some(true),
        Err(TryLockError::Error(_)) => None,
    }
}

fn remove(folder: &Path, which: impl Fn(&str, SystemTime) -> bool) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if !(name.starts_with('.') && name.ends_with(".tmp")) {
            continue;
        }
        let modified = entry.metadata().and_then(|data| data.modified()).unwrap_or_else(|_| SystemTime::now());
        if which(&name, modified) {
            // A file that remains does no harm.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Returns the process number in the name of a temporary file.
fn process_of(name: &str) -> Option<u32> {
    let (rest, number) = name.strip_suffix(".tmp")?.rsplit_once('-')?;
    number.parse::<u64>().ok()?;
    rest.rsplit(['.', '-']).next()?.parse().ok()
}

/// Returns whether a process of that number exists. Where the system does not show that, only the lock counts.
fn is_alive(process: u32) -> bool {
    Path::new("/proc").join(process.to_string()).exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(folder: &Path, name: &str, age: Duration) {
        let file = File::create(folder.join(name)).expect("written");
        file.set_modified(SystemTime::now() - age).expect("a time");
    }

    #[test]
    fn only_what_nobody_writes_is_removed() {
        let folder = tempfile::tempdir().expect("a folder");
        let own = std::process::id();
        let hour = Duration::from_secs(3600);
        // No process can have this number.
        let cases = [
            (".a.exr.4294967290-0.tmp".to_owned(), hour, false),
            (".a-001.exr.4294967290-12.tmp".to_owned(), hour, false),
            (".spectra-4294967290-0.tmp".to_owned(), Duration::ZERO, false),
            (".b.exr.4294967290-1.tmp".to_owned(), Duration::ZERO, false),
            (".held.exr.4294967290-1.tmp".to_owned(), hour, true),
            (format!(".a.exr.{own}-0.tmp"), hour, !cfg!(not(target_os = "linux"))),
            ("a.exr".to_owned(), hour, true),
            (".a.tmp".to_owned(), hour, true),
            (".a.4294967290.tmp".to_owned(), hour, true),
        ];
        for (name, age, _) in &cases {
            put(folder.path(), name, *age);
        }
        // This imitates a writer in another container, whose processes are not visible here.
        let held = File::open(folder.path().join(".held.exr.4294967290-1.tmp")).expect("there");
        held.lock().expect("locked");
        remove_stale_temporaries(folder.path());
        for (name, _, stays) in &cases {
            assert_eq!(folder.path().join(name).exists(), *stays, "{name}");
        }
        remove_own(folder.path());
        assert!(!folder.path().join(format!(".a.exr.{own}-0.tmp")).exists());
        assert!(folder.path().join(".held.exr.4294967290-1.tmp").exists());
    }
}
