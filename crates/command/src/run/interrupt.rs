//! Ctrl-C: once to stop and keep what there is, twice to give it up.

use crate::console;
use crate::outcome::INTERRUPTED;
use spectra_render::Control;
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering::SeqCst};
use std::sync::{Arc, Mutex, PoisonError};

/// How often the person at the keyboard (or the system, by SIGTERM or SIGHUP) asked for an end.
pub(crate) struct Interrupt {
    count: Arc<AtomicU32>,
    /// The render that goes on.
    control: Arc<Mutex<Arc<Control>>>,
}

impl Interrupt {
    /// From now on it is this render that is to stop.
    pub(crate) fn stops(&self, control: &Arc<Control>) {
        *self.control.lock().unwrap_or_else(PoisonError::into_inner) = Arc::clone(control);
        // Who asked while nothing could hear it asked all the same.
        if self.happened() {
            control.stop();
        }
    }

    /// Whether an end was asked for.
    pub(crate) fn happened(&self) -> bool {
        self.count.load(SeqCst) > 0
    }
}

/// Listens from now on. Given up, nothing half written stays in `folder`.
pub(crate) fn listen(control: &Arc<Control>, folder: &Path) -> Interrupt {
    let count = Arc::new(AtomicU32::new(0));
    let control = Arc::new(Mutex::new(Arc::clone(control)));
    let (counter, current, folder) = (Arc::clone(&count), Arc::clone(&control), folder.to_owned());
    let listening = ctrlc::set_handler(move || {
        if counter.fetch_add(1, SeqCst) == 0 {
            current.lock().unwrap_or_else(PoisonError::into_inner).stop();
        } else {
            remove_temporary(&folder);
            std::process::exit(i32::from(INTERRUPTED));
        }
    });
    if let Err(error) = listening {
        console::warning(&format!("Ctrl-C will not keep what was rendered: {error}"));
    }
    Interrupt { count, control }
}

/// Removes the files that this process was writing: `.NAME.PROCESS-NUMBER.tmp`.
fn remove_temporary(folder: &Path) {
    let mark = format!(".{}-", std::process::id());
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if name.starts_with('.') && name.ends_with(".tmp") && name.contains(&mark) {
            // The process ends here; there is nobody to tell.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_own_temporary_files_are_removed() {
        let folder = std::env::temp_dir().join(format!("spectra-interrupt-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let own = format!(".a.exr.{}-0.tmp", std::process::id());
        let names = [own.as_str(), ".a.exr.1-0.tmp", "a.exr", "a.tmp"];
        for name in names {
            std::fs::write(folder.join(name), "").expect("written");
        }
        remove_temporary(&folder);
        assert_eq!(names.map(|name| folder.join(name).exists()), [false, true, true, true]);
        std::fs::remove_dir_all(&folder).expect("removed");
    }
}
