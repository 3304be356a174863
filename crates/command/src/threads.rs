//! Threads for what is worked on side by side outside of tracing: films, pictures.

/// Makes them once. Where the system gives no thread, this one does all the work.
pub(crate) fn make() {
    let made = rayon::ThreadPoolBuilder::new().build_global();
    if made.is_err() {
        // Nothing is lost where this fails, too: the first that needs threads says so.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
    }
}
