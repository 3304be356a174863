//! Ctrl-C: the first stops and keeps the picture so far, the second discards it.

use crate::console;
use spectra_files::leftover;
use spectra_session::Control;
use std::path::Path;
use std::sync::atomic::{AtomicU8, AtomicU32, Ordering::SeqCst};
use std::sync::{Arc, Mutex, PoisonError};

/// Number of SIGINT, the signal of Ctrl-C.
const CTRL_C: u8 = 2;

/// Record of requests to stop, by Ctrl-C or by the system (SIGTERM, SIGHUP).
pub(crate) struct Interrupt {
    count: Arc<AtomicU32>,
    /// Number of the signal that came first.
    signal: Arc<AtomicU8>,
    /// Control of the current render.
    control: Arc<Mutex<Arc<Control>>>,
}

impl Interrupt {
    /// Makes `control` the render that a signal stops. Stops it at once if a signal has already arrived.
    pub(crate) fn stops(&self, control: &Arc<Control>) {
        *self.control.lock().unwrap_or_else(PoisonError::into_inner) = Arc::clone(control);
        // A signal may have arrived while no render was registered.
        if self.is_requested() {
            control.stop();
        }
    }

    /// Whether a request to stop has arrived.
    pub(crate) fn is_requested(&self) -> bool {
        self.count.load(SeqCst) > 0
    }

    /// Exit code of an interrupted command: 128 + the number of the signal, the convention of shells.
    pub(crate) fn code(&self) -> u8 {
        128 + self.signal.load(SeqCst)
    }
}

/// Starts listening for signals. The first signal stops the render; a second one removes partly written files from `folder` and ends
/// the process.
pub(crate) fn listen(control: &Arc<Control>, folder: &Path) -> Interrupt {
    let (count, first) = (Arc::new(AtomicU32::new(0)), Arc::new(AtomicU8::new(CTRL_C)));
    let control = Arc::new(Mutex::new(Arc::clone(control)));
    if console::is_captured() {
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
        console::warning(&format!("Ctrl-C will discard the picture so far instead of saving it: {error}"));
    }
    Interrupt { count, signal: first, control }
}

/// Calls `heard` with the number of each signal that requests a stop (SIGINT, SIGTERM, SIGHUP), on a separate thread.
#[cfg(unix)]
fn on_signal(mut heard: impl FnMut(u8) + Send + 'static) -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP])?;
    let listen = move || signals.forever().for_each(|signal| heard(u8::try_from(signal).unwrap_or(CTRL_C)));
    std::thread::Builder::new().name("signals".to_owned()).spawn(listen).map(drop)
}

/// Calls `heard` on each Ctrl-C, on a separate thread.
#[cfg(not(unix))]
fn on_signal(mut heard: impl FnMut(u8) + Send + 'static) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(move || heard(CTRL_C))
}
