//! Standard output and standard error. Nothing here panics when the other end is closed.
//!
//! The streams are those of the process, or buffers in memory if a program calls the command in its own process
//! ([`crate::call`]). A command writes only from the thread it was called on, so the choice is made per thread.

use spectra_core::params::{Fault, Faults, Warning};
use spectra_scene::diagnostics;
use spectra_sheet::Sheet;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::thread::ThreadId;

/// Output of a command whose streams were captured in memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct CapturedOutput {
    /// Bytes written to standard output.
    pub out: Vec<u8>,
    /// Bytes written to standard error.
    pub err: Vec<u8>,
}

/// Output so far of each thread whose streams are captured. There are only a few such threads at a time.
static KEPT: Mutex<Vec<(ThreadId, CapturedOutput)>> = Mutex::new(Vec::new());

/// Calls `then` with the captured output of this thread, or with `None` if the thread writes to the streams of the process.
fn with_captured<T>(then: impl FnOnce(Option<&mut CapturedOutput>) -> T) -> T {
    let own = std::thread::current().id();
    let mut all = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    then(all.iter_mut().find(|(thread, _)| *thread == own).map(|(_, kept)| kept))
}

/// Runs `work` with the streams of this thread captured in memory; returns its result and its output.
pub(crate) fn captured<T>(work: impl FnOnce() -> T) -> (T, CapturedOutput) {
    let own = std::thread::current().id();
    let all = || KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    all().push((own, CapturedOutput::default()));
    let done = work();
    let mut all = all();
    let at = all.iter().position(|(thread, _)| *thread == own);
    (done, at.map(|at| all.swap_remove(at).1).unwrap_or_default())
}

/// Whether the streams of this thread are captured in memory. The process then belongs to another program.
pub(crate) fn is_captured() -> bool {
    with_captured(|kept| kept.is_some())
}

/// Standard output of the command, as a writer.
pub(crate) struct Out;

impl Write for Out {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        with_captured(|kept| match kept {
            Some(kept) => kept.out.write(bytes),
            None => io::stdout().write(bytes),
        })
    }

    fn flush(&mut self) -> io::Result<()> {
        if is_captured() { Ok(()) } else { io::stdout().flush() }
    }
}

/// Writes a text to standard output.
///
/// # Errors
/// Fails if the text cannot be written, including when the reader has gone away. The caller decides whether that matters.
pub(crate) fn out(text: &str) -> io::Result<()> {
    Out.write_all(text.as_bytes())?;
    Out.flush()
}

/// Writes a message of the argument parser: help and version to standard output, errors to standard error.
pub(crate) fn parsed(said: &clap::Error) {
    // It is not an error if the reader has gone away.
    if !is_captured() {
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
/// Fails like [`out`].
pub(crate) fn json(value: &serde_json::Value) -> io::Result<()> {
    out(&format!("{value}\n"))
}

/// Writes a value as indented JSON to standard output, readable by programs and people.
///
/// # Errors
/// Fails like [`out`], and if the value has no JSON form.
pub(crate) fn pretty_json(value: &impl serde::Serialize) -> io::Result<()> {
    let text = serde_json::to_string_pretty(value).map_err(io::Error::other)?;
    out(&format!("{text}\n"))
}

/// Writes a result to standard output: as indented JSON, or as text.
///
/// # Errors
/// Fails like [`out`].
pub(crate) fn sheet(sheet: &Sheet, as_json: bool) -> io::Result<()> {
    if as_json { pretty_json(&sheet.to_json()) } else { out(&sheet.to_text()) }
}

/// Writes several results to standard output: as an indented JSON array, or as texts with a blank line between them.
///
/// # Errors
/// Fails like [`out`].
pub(crate) fn sheets(sheets: &[Sheet], as_json: bool) -> io::Result<()> {
    if as_json {
        return pretty_json(&sheets.iter().map(Sheet::to_json).collect::<Vec<_>>());
    }
    out(&sheets.iter().map(Sheet::to_text).collect::<Vec<_>>().join("\n"))
}

/// Writes a line to standard error. A failure is ignored, because there is nowhere left to report it.
pub(crate) fn note(line: &str) {
    let _ = with_captured(|kept| match kept {
        Some(kept) => writeln!(kept.err, "{line}"),
        None => writeln!(io::stderr().lock(), "{line}"),
    });
}

/// Writes a warning to standard error.
pub(crate) fn warning(text: &str) {
    note(&format!("warning: {text}"));
}

/// Writes a warning about a scene to standard error: its place in the file (or else the scene file), the text, then the hint.
pub(crate) fn scene_warning(warning: &Warning, scene: Option<&Path>) {
    let Fault { message, hint, .. } = &warning.0;
    let place = warning.0.place_text().or_else(|| scene.map(|path| path.display().to_string()));
    let place = place.map_or_else(String::new, |place| format!("{place}: "));
    let hint = hint.as_ref().map_or_else(String::new, |hint| format!("\n  help: {hint}"));
    crate::console::warning(&format!("{place}{message}{hint}"));
}

/// Writes an error to standard error.
pub(crate) fn error(text: &str) {
    note(&format!("error: {text}"));
}

/// Writes all faults of a file to standard error, with their count if there are several.
pub(crate) fn faults(faults: &Faults) {
    let text = diagnostics::render(faults, stderr_is_colored());
    note(text.trim_end());
    if faults.len() > 1 {
        error(&format!("{} faults", faults.len()));
    }
}

/// Whether standard error can show a moving progress bar.
pub(crate) fn stderr_moves() -> bool {
    !is_captured() && io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}

/// Whether standard error shows colors (<https://no-color.org>).
pub(crate) fn stderr_is_colored() -> bool {
    stderr_moves() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}
