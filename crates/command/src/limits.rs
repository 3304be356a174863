//! What the system gives a process, and where it ends.

/// Processors that this process may use.
pub(crate) fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// From now on a file beyond the limit of the process (`ulimit -f`) is a write that fails, as on a full disk, and no longer the
/// end of the process: what was rendered can be kept elsewhere.
#[cfg(unix)]
pub(crate) fn report_large_files() {
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;
    // Heard and not heeded. Where it cannot be, the signal does what it did.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::new(AtomicBool::new(false)));
}

/// Other systems have no such limit.
#[cfg(not(unix))]
pub(crate) fn report_large_files() {}
