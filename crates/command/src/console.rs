//! The two streams to a person or a program. Nothing here panics when the other end is closed.

use spectra_core::params::{Fault, Faults, Warning};
use spectra_scene::diagnostics;
use std::io::{self, IsTerminal, Write};
use std::path::Path;

/// Writes a text to standard output.
///
/// # Errors
/// Also where the reader has gone away: the caller decides whether that matters.
pub(crate) fn out(text: &str) -> io::Result<()> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes())?;
    stdout.flush()
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
    let _ = writeln!(io::stderr().lock(), "{line}");
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
    io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}

/// Whether standard error shows colors (<https://no-color.org>).
pub(crate) fn stderr_is_colored() -> bool {
    stderr_moves() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}
