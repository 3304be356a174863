//! Ctrl-C: once to stop and keep what there is, twice to give it up.

use crate::console;
use spectra_files::leftover;
use spectra_session::Control;
use std::path::Path;
use std::sync::atomic::{AtomicU8, AtomicU32, Ordering::SeqCst};
use std::sync::{Arc, Mutex, PoisonError};

/// SIGINT, as Ctrl-C sends it.
const CTRL_C: u8 = 2;

/// How often the person at the keyboard (or the system, by SIGTERM or SIGHUP) asked for an end.
pub(crate) struct Interrupt {
    count: Arc<AtomicU32>,
    /// The signal that asked first.
    signal: Arc<AtomicU8>,
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

    /// The exit code of what was interrupted: 128 + the signal, as shells have it.
    pub(crate) fn code(&self) -> u8 {
        128 + self.signal.load(SeqCst)
    }
}

/// Listens from now on. Given up, nothing half written stays in `folder`.
pub(crate) fn listen(control: &Arc<Control>, folder: &Path) -> Interrupt {
    let (count, first) = (Arc::new(AtomicU32::new(0)), Arc::new(AtomicU8::new(CTRL_C)));
    let control = Arc::new(Mutex::new(Arc::clone(control)));
    if console::is_kept() {
        // Signals belong to the program that called the command.
        return Interrupt { count, signal: first, control };
    }
    let (counter, said, current, folder) =
        (Arc::clone(&count), Arc::clone(&first), Arc::clone(&control), folder.to_owned());
    let listening = on_signal(move |signal| {
        if counter.load(SeqCst) == 0 {
            said.store(signal, SeqCst);
            counter.store(1, SeqCst);
            current.lock().unwrap_or_else(PoisonError::into_inner).stop();
        } else {
            leftover::remove_own(&folder);
            std::process::exit(i32::from(128 + signal));
        }
    });
    if let Err(error) = listening {
        console::warning(&format!("Ctrl-C will not keep what was rendered: {error}"));
    }
    Interrupt { count, signal: first, control }
}

/// Calls `heard` with the number of each signal that asks for an end, on a thread of its own.
#[cfg(unix)]
fn on_signal(mut heard: impl FnMut(u8) + Send + 'static) -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP])?;
    let listen = move || signals.forever().for_each(|signal| heard(u8::try_from(signal).unwrap_or(CTRL_C)));
    std::thread::Builder::new().name("signals".to_owned()).spawn(listen).map(drop)
}

/// Calls `heard` where the person at the keyboard asks for an end, on a thread of its own.
#[cfg(not(unix))]
fn on_signal(mut heard: impl FnMut(u8) + Send + 'static) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(move || heard(CTRL_C))
}
