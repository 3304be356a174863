//! Work that gives way: whoever turns a control does not wait for the picture of before.

use std::sync::OnceLock;

/// So many threads do the work, and this one waits for them. What answers a page, and the browser on the same machine, run before them.
pub(super) fn each(threads: usize, work: &(dyn Fn() + Sync)) {
    let is_begun = std::thread::scope(|scope| {
        let begin = |number: usize| {
            let thread = std::thread::Builder::new().name(format!("render {number}"));
            let giving_way = || {
                give_way();
                work();
            };
            thread.spawn_scoped(scope, giving_way).is_ok()
        };
        // Where the system has no more threads, fewer do all the work.
        (0..threads.max(1)).take_while(|number| begin(*number)).count() > 0
    });
    if !is_begun {
        work();
    }
}

/// Threads for the development of pictures that give way, the same for all pages, so many as the first of them asks for; `None` where
/// the system has no more.
pub(super) fn pool(threads: usize) -> Option<&'static rayon::ThreadPool> {
    static POOL: OnceLock<Option<rayon::ThreadPool>> = OnceLock::new();
    let made = || {
        // A panic is said by its thread, and ends no other picture.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.max(1)).panic_handler(|_| {});
        pool.start_handler(|_| give_way()).thread_name(|number| format!("develop {number}")).build().ok()
    };
    POOL.get_or_init(made).as_ref()
}

/// Lets this thread run where no other wants to. Linux has a priority of each thread; elsewhere all stay equal.
fn give_way() {
    #[cfg(target_os = "linux")]
    let _ = rustix::process::nice(10);
}
