//! Threads for a program that has none of its own.

use spectra_core::workers::Workers;

/// Runs work on this many threads of the process, started anew for each piece of work. For programs without threads of their own.
#[derive(Clone, Copy, Debug)]
pub struct Threads(pub usize);

impl Workers for Threads {
    fn run_on_all(&self, work: &(dyn Fn() + Sync)) {
        std::thread::scope(|scope| {
            for number in 1..self.0 {
                let thread = std::thread::Builder::new().name(format!("render {number}"));
                // If the system cannot start more threads, fewer do all the work.
                if thread.spawn_scoped(scope, work).is_err() {
                    break;
                }
            }
            work();
        });
    }
}
