//! Enforces `--time-limit` while the scene is set up, before any light is traced.

use crate::console;
use crate::formatting;
use crate::outcome::DONE;
use serde_json::json;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering::SeqCst};
use std::time::Instant;

const SETTING_UP: u8 = 0;
const TRACING: u8 = 1;
const OVER: u8 = 2;

/// Ends the program if the time limit passes before light is traced. Nothing has been written by then, so nothing is lost.
pub(crate) struct SetUp {
    state: Arc<AtomicU8>,
}

impl SetUp {
    /// Starts watching until `deadline`, which is `limit_s` seconds after the start of the program. Does not watch if another program
    /// called the command in its own process, because that process must not end here.
    pub(crate) fn watched(deadline: Option<Instant>, limit_s: f64, is_json: bool, is_quiet: bool) -> Self {
        let state = Arc::new(AtomicU8::new(SETTING_UP));
        if let Some(deadline) = deadline.filter(|_| !console::is_captured()) {
            let state = Arc::clone(&state);
            // If no thread can be started, the limit applies only once light is traced.
            let _ = std::thread::Builder::new().name("time limit".to_owned()).spawn(move || {
                std::thread::sleep(deadline.saturating_duration_since(Instant::now()));
                if state.compare_exchange(SETTING_UP, OVER, SeqCst, SeqCst).is_ok() {
                    say(limit_s, is_json, is_quiet);
                    std::process::exit(i32::from(DONE));
                }
            });
        }
        Self { state }
    }

    /// Ends the watch because light is traced from now on.
    pub(crate) fn done(&self) {
        if self.state.compare_exchange(SETTING_UP, TRACING, SeqCst, SeqCst) == Err(OVER) {
            // The watching thread is ending the program.
            loop {
                std::thread::park();
            }
        }
    }
}

impl Drop for SetUp {
    /// Ends the watch, so that the error of a scene that cannot be rendered is reported even at the last moment.
    fn drop(&mut self) {
        self.done();
    }
}

fn say(limit_s: f64, is_json: bool, is_quiet: bool) {
    let text = format!(
        "the time limit of {} ended before rendering began: nothing was written",
        formatting::duration(limit_s)
    );
    if is_json {
        let _ = console::json(&json!({ "event": "stopping", "message": text }));
    } else if !is_quiet {
        console::warning(&text);
    }
}
