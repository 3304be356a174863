//! What goes on between a running render and the one who started it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::time::Instant;

/// Shared between a render and its watcher: a request to stop one way, progress the other.
#[derive(Debug, Default)]
pub struct Control {
    stop: AtomicBool,
    deadline: Option<Instant>,
    rays: AtomicU64,
    total_rays: AtomicU64,
}

impl Control {
    /// No limit of time.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The render stops cleanly at `deadline`.
    #[must_use]
    pub fn until(deadline: Instant) -> Self {
        Self { deadline: Some(deadline), ..Self::default() }
    }

    /// Asks the render to stop; it does within one unit of work.
    pub fn stop(&self) {
        self.stop.store(true, Relaxed);
    }

    /// Whether it should stop now.
    #[must_use]
    pub fn should_stop(&self) -> bool {
        self.stop.load(Relaxed) || self.deadline.is_some_and(|d| Instant::now() >= d)
    }

    /// Rays launched so far.
    #[must_use]
    pub fn rays(&self) -> u64 {
        self.rays.load(Relaxed)
    }

    /// Rays to launch in all; 0 before the render knows.
    #[must_use]
    pub fn total_rays(&self) -> u64 {
        self.total_rays.load(Relaxed)
    }

    pub(crate) fn launched(&self, rays: u64) {
        self.rays.fetch_add(rays, Relaxed);
    }

    pub(crate) fn expect(&self, rays: u64) {
        self.total_rays.store(rays, Relaxed);
    }
}
