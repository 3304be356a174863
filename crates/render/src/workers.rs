//! Who does the work: threads belong to the program that renders, not to the engine.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// Some threads.
pub trait Workers: Sync {
    /// Calls `work` once on each of them, and returns when all calls have.
    fn each(&self, work: &(dyn Fn() + Sync));
}

/// The thread that asks.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alone;

impl Workers for Alone {
    fn each(&self, work: &(dyn Fn() + Sync)) {
        work();
    }
}

/// So many threads of this process, made for each piece of work: for a program that has none of its own.
#[derive(Clone, Copy, Debug)]
pub struct Threads(pub usize);

impl Workers for Threads {
    fn each(&self, work: &(dyn Fn() + Sync)) {
        std::thread::scope(|scope| {
            for number in 1..self.0 {
                let thread = std::thread::Builder::new().name(format!("render {number}"));
                // Where the system has no more threads, fewer do all the work.
                if thread.spawn_scoped(scope, work).is_err() {
                    break;
                }
            }
            work();
        });
    }
}

/// Does so many pieces of work, each on one of the workers, who has columns of its own; gives their results in order.
pub(crate) fn each_of<S, T: Send, E: Send>(
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
