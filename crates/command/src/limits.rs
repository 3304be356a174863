//! Limits that the system sets for this process: processors and file size.

/// Number of processors that this process may use.
pub(crate) fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Makes a write beyond the file size limit (`ulimit -f`) fail like a write to a full disk, instead of killing the process. The
/// rendered data can then be saved elsewhere.
#[cfg(unix)]
pub(crate) fn report_large_files() {
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;
    // The signal is caught and ignored. If it cannot be caught, it keeps its default action.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::new(AtomicBool::new(false)));
}

/// Does nothing: systems other than Unix have no file size limit.
#[cfg(not(unix))]
pub(crate) fn report_large_files() {}
