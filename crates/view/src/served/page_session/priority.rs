//! Threads of low priority: after a change, nobody has to wait for work on the previous picture.
//!
//! The whole picture is traced and developed by such threads. Drafts, the server and the browser on the same machine run before them. Only
//! Linux has a priority per thread; elsewhere all threads are equal.

use spectra_session::{Control as Stop, Workers};
use std::sync::OnceLock;

/// Threads of low priority whose work stops when something changes.
pub(super) struct Until<'a> {
    pub(super) threads: usize,
    pub(super) stop: &'a Stop,
}

impl Workers for Until<'_> {
    fn run_on_all(&self, work: &(dyn Fn() + Sync)) {
        each(self.threads, work);
    }

    fn should_stop(&self) -> bool {
        self.stop.should_stop()
    }
}

/// Does the work on this many threads of low priority, and waits for them. Threads that answer the page, and the browser on the same
/// machine, run before them.
fn each(threads: usize, work: &(dyn Fn() + Sync)) {
    let is_begun = std::thread::scope(|scope| {
        let begin = |number: usize| {
            let thread = std::thread::Builder::new().name(format!("render {number}"));
            let giving_way = || {
                give_way();
                work();
            };
            thread.spawn_scoped(scope, giving_way).is_ok()
        };
        // If the system has no more threads, fewer threads do all the work.
        (0..threads.max(1)).take_while(|number| begin(*number)).count() > 0
    });
    if !is_begun {
        work();
    }
}

/// Returns the pool of low-priority threads that develop pictures. All pages share it; it has as many threads as the first page asks for.
/// `None` if the system has no more threads.
pub(super) fn pool(threads: usize) -> Option<&'static rayon::ThreadPool> {
    static POOL: OnceLock<Option<rayon::ThreadPool>> = OnceLock::new();
    let made = || {
        // A panic is printed by its thread, and does not affect other pictures.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.max(1)).panic_handler(|_| {});
        pool.start_handler(|_| give_way()).thread_name(|number| format!("develop {number}")).build().ok()
    };
    POOL.get_or_init(made).as_ref()
}

/// Lowers the priority of this thread. Only Linux has a priority for each thread; on other systems all threads stay equal.
fn give_way() {
    #[cfg(target_os = "linux")]
    let _ = rustix::process::nice(10);
}
