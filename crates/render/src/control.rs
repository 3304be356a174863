//! What goes on between a running render and the one who started it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// Shared between a render and its watcher: a request to stop one way, progress the other.
#[derive(Debug, Default)]
pub struct Control {
    stop: AtomicBool,
    rays: AtomicU64,
    total_rays: AtomicU64,
}

impl Control {
    /// Nobody has asked for an end.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks the render to stop; it does within one unit of work.
    pub fn stop(&self) {
        self.stop.store(true, Relaxed);
    }

    /// Whether it should stop now.
    #[must_use]
    pub fn should_stop(&self) -> bool {
        self.stop.load(Relaxed)
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
