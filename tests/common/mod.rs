//! The program as its users run it.
#![allow(dead_code, reason = "each test binary uses its part of this module")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A command line that starts with `spectra`, with no setting of the tester's own.
pub fn spectra() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_spectra"));
    command.env_remove("SPECTRA_ISA").env_remove("NO_COLOR").stdin(Stdio::null());
    command
}

/// Runs `spectra` with these arguments.
pub fn run(arguments: &[&str]) -> Output {
    spectra().args(arguments).output().expect("the program starts")
}

/// Standard output of a run that must succeed.
pub fn good(arguments: &[&str]) -> String {
    let output = run(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// Does the jobs on all processors: a program that only reads a scene has one thread. Answers come in the order of the jobs.
pub fn together<T: Sync, R: Send>(jobs: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let some = || {
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(job) = jobs.get(at) else { return };
            let answer = work(job);
            done.lock().expect("no thread panics").push((at, answer));
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(some);
        }
    });
    let mut done = done.into_inner().expect("no thread panics");
    done.sort_by_key(|(at, _)| *at);
    done.into_iter().map(|(_, answer)| answer).collect()
}

/// A stream as text.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("the program writes UTF-8")
}

/// A file of the repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// A path as an argument.
pub fn shown(path: &Path) -> &str {
    path.to_str().expect("a path of plain letters")
}

/// A lens of the test data, as an argument.
pub fn lens(name: &str) -> String {
    shown(&repository(&format!("tests/data/lenses/{name}.yaml"))).to_owned()
}

/// Rows of a CSV file of the test data, which has no quotes, without the first one.
pub fn rows(name: &str) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(repository(&format!("tests/data/{name}"))).expect("test data");
    text.lines().skip(1).map(|row| row.split(',').map(str::to_owned).collect()).collect()
}
