//! Ctrl-C: once to stop and keep what there is, twice to give it up.

use crate::console;
use crate::outcome::INTERRUPTED;
use spectra_render::Control;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering::SeqCst};

/// How often the person at the keyboard (or the system, by SIGTERM or SIGHUP) asked for an end.
pub(crate) struct Interrupt {
    count: Arc<AtomicU32>,
}

impl Interrupt {
    /// Whether an end was asked for.
    pub(crate) fn happened(&self) -> bool {
        self.count.load(SeqCst) > 0
    }
}

/// Listens from now on.
pub(crate) fn listen(control: &Arc<Control>) -> Interrupt {
    let count = Arc::new(AtomicU32::new(0));
    let (counter, control) = (Arc::clone(&count), Arc::clone(control));
    let listening = ctrlc::set_handler(move || {
        if counter.fetch_add(1, SeqCst) == 0 {
            control.stop();
        } else {
            std::process::exit(i32::from(INTERRUPTED));
        }
    });
    if let Err(error) = listening {
        console::warning(&format!("Ctrl-C will not keep what was rendered: {error}"));
    }
    Interrupt { count }
}
