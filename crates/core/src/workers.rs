//! Who does the work: threads belong to the program that renders, not to the engine.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// Some threads.
pub trait Workers: Sync {
    /// Calls `work` once on each of them, and returns when all calls have.
    fn each(&self, work: &(dyn Fn() + Sync));

    /// Whether whoever asked does not want the result any more. Once it is true it stays so. Work that heeds it ends early, with
    /// an error of its own.
    fn should_stop(&self) -> bool {
        false
    }
}

/// The thread that asks.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alone;

impl Workers for Alone {
    fn each(&self, work: &(dyn Fn() + Sync)) {
        work();
    }
}

/// Does so many pieces of work, each on one of the workers, who has columns of its own; gives their results in order.
///
/// # Errors
/// The first one, in the order of the pieces, of those that were met before the work stopped.
pub fn each_of<S, T: Send, E: Send>(
    workers: &dyn Workers,
    pieces: usize,
    fresh: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, usize) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<(usize, Result<T, E>)>> = Mutex::new(Vec::with_capacity(pieces));
    workers.each(&|| {
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
