//! Worker threads: they belong to the program that renders, not to the engine.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// A set of worker threads that run the same closure.
pub trait Workers: Sync {
    /// Calls `work` once on each thread, and returns when all calls have returned.
    fn run_on_all(&self, work: &(dyn Fn() + Sync));

    /// Returns whether the caller no longer wants the result. Once true, it stays true. Work that checks this ends early, with
    /// an error of its own.
    fn should_stop(&self) -> bool {
        false
    }
}

/// Workers that consist of the calling thread only.
#[derive(Clone, Copy, Debug, Default)]
pub struct SingleThread;

impl Workers for SingleThread {
    fn run_on_all(&self, work: &(dyn Fn() + Sync)) {
        work();
    }
}

/// Runs `work` for each piece, numbered from 0 to `pieces` - 1, on the workers, and returns the results in order. Each worker
/// creates its own state by `fresh` and passes it to `work`.
///
/// # Errors
/// The first error, in the order of the pieces, among those that occurred before the work stopped.
pub fn map_pieces<S, T: Send, E: Send>(
    workers: &dyn Workers,
    pieces: usize,
    fresh: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, usize) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<(usize, Result<T, E>)>> = Mutex::new(Vec::with_capacity(pieces));
    workers.run_on_all(&|| {
        let mut state = fresh();
        loop {
            let piece = next.fetch_add(1, Relaxed);
            if piece >= pieces {
                break;
            }
            let result = work(&mut state, piece);
            if result.is_err() {
                next.store(pieces, Relaxed);
            }
            done.lock().unwrap_or_else(PoisonError::into_inner).push((piece, result));
        }
    });
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.sort_unstable_by_key(|(piece, _)| *piece);
    done.into_iter().map(|(_, result)| result).collect()
}
