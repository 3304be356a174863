//! Enforces `--time-limit` until there is a picture to write.

use crate::console;
use crate::outcome::{FAILED, Failure, with_json_error};
use spectra_session::TimeSpent;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Ends the program if the time limit passes before there is a picture. Nothing has been written by then, so nothing is lost.
pub(crate) struct Watch {
    started: Instant,
    /// How long the work took so far; `None` once there is a picture.
    spent: Arc<Mutex<Option<TimeSpent>>>,
}

impl Watch {
    /// Starts watching until `limit_s` seconds after the start of the program. Does not watch if another program called the command in
    /// its own process, because that process must not end here.
    pub(crate) fn new(started: Instant, limit_s: Option<f64>, is_json: bool) -> Self {
        let spent = Arc::new(Mutex::new(limit_s.map(|limit_s| TimeSpent { limit_s, ..TimeSpent::default() })));
        if let Some(deadline) = deadline(started, limit_s).filter(|_| !console::is_captured()) {
            let spent = Arc::clone(&spent);
            // If no thread can be started, the limit applies only once there is a picture.
            let _ = std::thread::Builder::new().name("time limit".to_owned()).spawn(move || {
                std::thread::sleep(deadline.saturating_duration_since(Instant::now()));
                let spent = spent.lock().unwrap_or_else(PoisonError::into_inner);
                if let Some(spent) = *spent {
                    let failure = Failure::Failed(spent.too_short(started.elapsed().as_secs_f64()));
                    if let Err(failure) = with_json_error(Err(failure), is_json) {
                        failure.report();
                    }
                    std::process::exit(i32::from(FAILED));
                }
            });
        }
        Self { started, spent }
    }

    /// Records that the scene is prepared and tracing begins.
    pub(crate) fn prepared(&self) {
        let now_s = self.started.elapsed().as_secs_f64();
        self.record(|spent| spent.prepared_s = spent.prepared_s.or(Some(now_s)));
    }

    /// Records that the first pass over the frame is complete.
    pub(crate) fn passed(&self) {
        let now_s = self.started.elapsed().as_secs_f64();
        self.record(|spent| spent.pass_s = spent.prepared_s.map(|prepared_s| now_s - prepared_s));
    }

    /// Ends the watch because there is a picture from now on.
    pub(crate) fn done(&self) {
        // While the watching thread ends the program, it holds the lock, and this waits.
        *self.spent.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }

    fn record(&self, change: impl FnOnce(&mut TimeSpent)) {
        self.spent.lock().unwrap_or_else(PoisonError::into_inner).as_mut().map(change);
    }
}

impl Drop for Watch {
    /// Ends the watch, so that the error of a scene that cannot be rendered is reported even at the last moment.
    fn drop(&mut self) {
        self.done();
    }
}

/// Returns the moment `limit_s` seconds after the start of the program; `None` without a limit, or if it lies beyond all clocks.
pub(crate) fn deadline(started: Instant, limit_s: Option<f64>) -> Option<Instant> {
    started.checked_add(std::time::Duration::try_from_secs_f64(limit_s?).ok()?)
}
