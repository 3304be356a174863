//! Communication between a running render and its caller.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// State shared by a render and its caller. The caller asks the render to stop; the render reports its progress.
#[derive(Debug, Default)]
pub struct Control {
    stop: AtomicBool,
    rays: AtomicU64,
    total_rays: AtomicU64,
}

impl Control {
    /// Creates a state without a request to stop and without progress.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks the render to stop. It stops within one unit of work.
    pub fn stop(&self) {
        self.stop.store(true, Relaxed);
    }

    /// Whether the render should stop now.
    #[must_use]
    pub fn should_stop(&self) -> bool {
        self.stop.load(Relaxed)
    }

    /// Number of rays launched so far.
    #[must_use]
    pub fn rays(&self) -> u64 {
        self.rays.load(Relaxed)
    }

    /// Number of rays to launch in all; 0 until the render knows it.
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
