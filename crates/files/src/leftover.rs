//! Temporary files that stayed: `.NAME.PROCESS-NUMBER.tmp`, see [`super::write_atomically`].

use std::path::Path;
use std::time::{Duration, SystemTime};

/// What is this old and whose process is gone, nobody writes any more.
const OLD: Duration = Duration::from_secs(600);

/// Removes the files that this process was writing in `folder`.
pub fn remove_own(folder: &Path) {
    remove(folder, |name, _| process_of(name) == Some(std::process::id()));
}

/// Removes what runs left in `folder` that were killed: files of pictures whose names begin with `stem`, and attempts at
/// writing.
pub fn sweep(folder: &Path, stem: &str) {
    remove(folder, |name, modified| {
        let is_ours = name.strip_prefix('.').is_some_and(|n| n.starts_with(stem) || n.starts_with("spectra"));
        let is_old = SystemTime::now().duration_since(modified).is_ok_and(|age| age > OLD);
        is_ours && is_old && process_of(name).is_some_and(|process| !is_alive(process))
    });
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
            // A file that stays does no harm.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// The process in the name of a temporary file.
fn process_of(name: &str) -> Option<u32> {
    let (rest, number) = name.strip_suffix(".tmp")?.rsplit_once('-')?;
    number.parse::<u64>().ok()?;
    rest.rsplit(['.', '-']).next()?.parse().ok()
}

/// Whether a process of that number is there; where the system does not show it, the age of the file alone counts.
fn is_alive(process: u32) -> bool {
    Path::new("/proc").join(process.to_string()).exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(folder: &Path, name: &str, age: Duration) {
        let file = std::fs::File::create(folder.join(name)).expect("written");
        file.set_modified(SystemTime::now() - age).expect("a time");
    }

    #[test]
    fn only_what_nobody_writes_is_removed() {
        let folder = tempfile::tempdir().expect("a folder");
        let own = std::process::id();
        let hour = Duration::from_secs(3600);
        // A process of that number cannot be.
        let cases = [
            (".a.exr.4294967290-0.tmp".to_owned(), hour, false),
            (".a-001.exr.4294967290-12.tmp".to_owned(), hour, false),
            (".spectra-4294967290-0.tmp".to_owned(), hour, false),
            (".a.exr.4294967290-1.tmp".to_owned(), Duration::ZERO, true),
            (format!(".a.exr.{own}-0.tmp"), hour, !cfg!(not(target_os = "linux"))),
            (".b.exr.4294967290-0.tmp".to_owned(), hour, true),
            ("a.exr".to_owned(), hour, true),
            (".a.tmp".to_owned(), hour, true),
        ];
        for (name, age, _) in &cases {
            put(folder.path(), name, *age);
        }
        sweep(folder.path(), "a");
        for (name, _, stays) in &cases {
            assert_eq!(folder.path().join(name).exists(), *stays, "{name}");
        }
        remove_own(folder.path());
        assert!(!folder.path().join(format!(".a.exr.{own}-0.tmp")).exists());
        assert!(folder.path().join(".a.exr.4294967290-1.tmp").exists());
    }
}
