//! Threads, for a program that has none of its own.

use spectra_core::workers::Workers;

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
