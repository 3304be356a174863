//! Helpers that run the program as its users do.
#![allow(dead_code, reason = "each test program uses its part of this module")]

pub mod statistics;

use spectra_command::CommandOutput;
use spectra_plugins as _;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Output, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Returns a command that starts `spectra` without the tester's own settings.
pub fn spectra() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_spectra"));
    command.env_remove("SPECTRA_ISA").env_remove("NO_COLOR").stdin(Stdio::null());
    command
}

/// Runs `spectra` with these arguments inside this process, so that data are read only once for all tests. Use [`spectra`] for what
/// belongs to a process: signals, limits, streams, its environment.
pub fn run(arguments: &[&str]) -> Output {
    output(called(None, arguments).expect("no folder was asked for"))
}

/// Runs the program `spectra` with these arguments in `folder`.
pub fn run_in(folder: &Path, arguments: &[&str]) -> Output {
    spectra().current_dir(folder).args(arguments).output().expect("the program starts")
}

/// Runs `spectra` with arguments that write no file, in `folder`. It runs inside this process if a thread can have its own working
/// folder. Files are written by other threads of the process, which do not share that folder.
pub fn answer_in(folder: &Path, arguments: &[&str]) -> Output {
    called(Some(folder), arguments).map_or_else(|_| run_in(folder, arguments), output)
}

fn called(folder: Option<&Path>, arguments: &[&str]) -> io::Result<CommandOutput> {
    let own = || {
        folder.map_or(Ok(()), work_in)?;
        Ok(spectra_command::call(arguments.iter().map(Into::into), spectra_workspace::unpack))
    };
    std::thread::scope(|scope| {
        // A stack as large as that of the main thread.
        let thread = std::thread::Builder::new().stack_size(8 << 20).spawn_scoped(scope, own).expect("a thread");
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

fn output(called: CommandOutput) -> Output {
    Output { status: exit_status(called.code), stdout: called.out, stderr: called.err }
}

/// Gives this thread, and the threads that it starts, their own working folder.
#[cfg(target_os = "linux")]
#[allow(unsafe_code)]
fn work_in(folder: &Path) -> io::Result<()> {
    use rustix::thread::{UnshareFlags, unshare_unsafe};
    // SAFETY: file descriptors stay shared; the thread gets its own working folder, root and mask of new files, and nothing else.
    unsafe { unshare_unsafe(UnshareFlags::FS) }?;
    std::env::set_current_dir(folder)
}

/// Returns an error, because other systems have one working folder per process.
#[cfg(not(target_os = "linux"))]
fn work_in(_folder: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

fn exit_status(code: u8) -> ExitStatus {
    #[cfg(unix)]
    return std::os::unix::process::ExitStatusExt::from_raw(i32::from(code) << 8);
    #[cfg(windows)]
    return std::os::windows::process::ExitStatusExt::from_raw(u32::from(code));
}

/// Returns the standard output of a run that must succeed.
pub fn good(arguments: &[&str]) -> String {
    let output = run(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// Runs the jobs on all processors, because a program that only reads a scene uses one thread. Returns the answers in the order of
/// the jobs.
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

/// Returns a stream as text.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("the program writes UTF-8")
}

/// Returns the path of a file of the repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Returns a path as an argument.
pub fn shown(path: &Path) -> &str {
    path.to_str().expect("a path of plain letters")
}

/// Returns the path of a lens of the test data as an argument.
pub fn lens(name: &str) -> String {
    shown(&repository(&format!("tests/data/lenses/{name}.yaml"))).to_owned()
}

/// Returns the rows of a CSV file of the test data without its header; the file contains no quotes.
pub fn rows(name: &str) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(repository(&format!("tests/data/{name}"))).expect("test data");
    text.lines().skip(1).map(|row| row.split(',').map(str::to_owned).collect()).collect()
}
