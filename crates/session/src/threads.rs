//! Threads for what is worked on side by side outside of tracing: films, pictures.

/// Makes the threads that films and pictures are worked on with, once for a program. Where the system gives none, this thread does all the
/// work.
pub fn make_threads() {
    let made = rayon::ThreadPoolBuilder::new().build_global();
    if made.is_err() {
        // Nothing is lost where this fails, too: the first that needs threads says so.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
    }
}
