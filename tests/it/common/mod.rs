//! The program as its users run it.
#![allow(dead_code, reason = "each test program uses its part of this module")]

pub mod statistics;

use spectra_command::Called;
use spectra_plugins as _;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Output, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A command line that starts with `spectra`, with no setting of the tester's own.
pub fn spectra() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_spectra"));
    command.env_remove("SPECTRA_ISA").env_remove("NO_COLOR").stdin(Stdio::null());
    command
}

/// Runs `spectra` with these arguments, in this process: most of what the tests ask of it rests on data that are read once for all of
/// them then. What belongs to a process (signals, limits, streams, its environment) needs [`spectra`].
pub fn run(arguments: &[&str]) -> Output {
    output(called(None, arguments).expect("no folder was asked for"))
}

/// Runs `spectra` with these arguments in `folder`.
pub fn run_in(folder: &Path, arguments: &[&str]) -> Output {
    spectra().current_dir(folder).args(arguments).output().expect("the program starts")
}

/// Runs `spectra` with arguments that write no file, in `folder`: in this process, where a thread can have a working folder of its own.
/// A file is written by threads of the process, which do not have it.
pub fn answer_in(folder: &Path, arguments: &[&str]) -> Output {
    called(Some(folder), arguments).map_or_else(|_| run_in(folder, arguments), output)
}

fn called(folder: Option<&Path>, arguments: &[&str]) -> io::Result<Called> {
    let own = || {
        folder.map_or(Ok(()), work_in)?;
        Ok(spectra_command::call(arguments.iter().map(Into::into), spectra_workspace::unpack))
    };
    std::thread::scope(|scope| {
        // As large as the main thread's.
        let thread = std::thread::Builder::new().stack_size(8 << 20).spawn_scoped(scope, own).expect("a thread");
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

fn output(called: Called) -> Output {
    Output { status: exit_status(called.code), stdout: called.out, stderr: called.err }
}

/// Gives this thread, and those that it starts, a working folder of their own.
#[cfg(target_os = "linux")]
#[allow(unsafe_code)]
fn work_in(folder: &Path) -> io::Result<()> {
    use rustix::thread::{UnshareFlags, unshare_unsafe};
    // SAFETY: file descriptors stay shared; only the working folder, the root and the mask of new files become the thread's own.
    unsafe { unshare_unsafe(UnshareFlags::FS) }?;
    std::env::set_current_dir(folder)
}

/// Other systems have one working folder for a process.
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
