//! Threads for parallel work outside of tracing, such as on films and pictures.

/// Creates the threads for work on films and pictures, once in a program. If the system gives none, the current thread does all
/// the work.
pub fn make_threads() {
    let made = rayon::ThreadPoolBuilder::new().build_global();
    if made.is_err() {
        // A failure here loses nothing: the first code that needs threads reports it.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
    }
}
