//! The two streams to a person or a program. Nothing here panics when the other end is closed.
//!
//! They are the process's, or memory where a program calls the command in its own process ([`crate::call`]). A command writes
//! from the thread that it was called on, so the choice belongs to the thread.

use spectra_core::params::{Fault, Faults, Warning};
use spectra_scene::diagnostics;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::thread::ThreadId;

/// What a command wrote while its streams were kept in memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kept {
    /// Standard output.
    pub out: Vec<u8>,
    /// Standard error.
    pub err: Vec<u8>,
}

/// What threads that keep their streams have written so far: few at a time.
static KEPT: Mutex<Vec<(ThreadId, Kept)>> = Mutex::new(Vec::new());

/// Does something with what this thread keeps; `None` where it writes to the process's streams.
fn with_kept<T>(then: impl FnOnce(Option<&mut Kept>) -> T) -> T {
    let own = std::thread::current().id();
    let mut all = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    then(all.iter_mut().find(|(thread, _)| *thread == own).map(|(_, kept)| kept))
}

/// Runs `work` with the streams of this thread kept in memory; returns its result and what it wrote.
pub(crate) fn kept<T>(work: impl FnOnce() -> T) -> (T, Kept) {
    let own = std::thread::current().id();
    let all = || KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    all().push((own, Kept::default()));
    let done = work();
    let mut all = all();
    let at = all.iter().position(|(thread, _)| *thread == own);
    (done, at.map(|at| all.swap_remove(at).1).unwrap_or_default())
}

/// Whether the streams of this thread are kept in memory: then the process belongs to somebody else.
pub(crate) fn is_kept() -> bool {
    with_kept(|kept| kept.is_some())
}

/// Standard output, as something to write to.
pub(crate) struct Out;

impl Write for Out {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        with_kept(|kept| match kept {
            Some(kept) => kept.out.write(bytes),
            None => io::stdout().write(bytes),
        })
    }

    fn flush(&mut self) -> io::Result<()> {
        if is_kept() { Ok(()) } else { io::stdout().flush() }
    }
}

/// Writes a text to standard output.
///
/// # Errors
/// Also where the reader has gone away: the caller decides whether that matters.
pub(crate) fn out(text: &str) -> io::Result<()> {
    Out.write_all(text.as_bytes())?;
    Out.flush()
}

/// Help and version, on standard output, or what the parser of arguments says about a mistake, on standard error.
pub(crate) fn parsed(said: &clap::Error) {
    // A reader that has gone away is no failure.
    if !is_kept() {
        drop(said.print());
    } else if said.use_stderr() {
        note(said.render().to_string().trim_end_matches('\n'));
    } else {
        drop(out(&said.render().to_string()));
    }
}

/// Writes a value as one line of JSON to standard output.
///
/// # Errors
/// As [`out`].
pub(crate) fn json(value: &serde_json::Value) -> io::Result<()> {
    out(&format!("{value}\n"))
}

/// Writes a value as JSON for a program that a person may look at too.
///
/// # Errors
/// As [`out`].
pub(crate) fn pretty_json(value: &impl serde::Serialize) -> io::Result<()> {
    let text = serde_json::to_string_pretty(value).map_err(io::Error::other)?;
    out(&format!("{text}\n"))
}

/// Writes a line to standard error; there is nobody to tell where that fails.
pub(crate) fn note(line: &str) {
    let _ = with_kept(|kept| match kept {
        Some(kept) => writeln!(kept.err, "{line}"),
        None => writeln!(io::stderr().lock(), "{line}"),
    });
}

/// A warning, on standard error.
pub(crate) fn warning(text: &str) {
    note(&format!("warning: {text}"));
}

/// A warning about a scene, on standard error: its place (or else the scene) and the text, then what to do about it.
pub(crate) fn said(warning: &Warning, scene: Option<&Path>) {
    let Fault { message, hint, .. } = &warning.0;
    let place = warning.0.place_text().or_else(|| scene.map(|path| path.display().to_string()));
    let place = place.map_or_else(String::new, |place| format!("{place}: "));
    let hint = hint.as_ref().map_or_else(String::new, |hint| format!("\n  help: {hint}"));
    crate::console::warning(&format!("{place}{message}{hint}"));
}

/// An error, on standard error.
pub(crate) fn error(text: &str) {
    note(&format!("error: {text}"));
}

/// All that is wrong with a file, on standard error.
pub(crate) fn faults(faults: &Faults) {
    let text = diagnostics::render(faults, stderr_is_colored());
    note(text.trim_end());
    if faults.len() > 1 {
        error(&format!("{} faults", faults.len()));
    }
}

/// Whether standard error shows a moving progress bar.
pub(crate) fn stderr_moves() -> bool {
    !is_kept() && io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}

/// Whether standard error shows colors (<https://no-color.org>).
pub(crate) fn stderr_is_colored() -> bool {
    stderr_moves() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}
