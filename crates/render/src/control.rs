//! Communication between a running render and its caller.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// State shared by a render and its caller. The caller asks the render to stop; the render reports its progress.
#[derive(Debug, Default)]
pub struct Control {
    stop: AtomicBool,
    pause: AtomicBool,
    rays: AtomicU64,
    total_rays: AtomicU64,
    /// Number of rays after which the render stops; 0 for no such number.
    last_ray: u64,
}

impl Control {
    /// Creates a state without a request to stop and without progress.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Creates a state that asks to stop once this many rays are launched, at least 1.
    #[must_use]
    pub fn stopping_after(rays: u64) -> Self {
        Self { last_ray: rays.max(1), ..Self::default() }
    }

    /// Asks the render to stop. It stops within one unit of work.
    pub fn stop(&self) {
        self.stop.store(true, Relaxed);
    }

    /// Asks the render to return to its caller, who looks at the light so far and then continues.
    pub fn pause(&self) {
        self.pause.store(true, Relaxed);
    }

    /// Ends a pause. Returns whether one was asked for.
    pub fn resume(&self) -> bool {
        self.pause.swap(false, Relaxed)
    }

    /// Whether the render should stop now, for good or for a pause.
    #[must_use]
    pub fn should_stop(&self) -> bool {
        self.is_stopped() || self.pause.load(Relaxed)
    }

    /// Whether the render should stop for good.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
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
        let launched = self.rays.fetch_add(rays, Relaxed) + rays;
        if self.last_ray > 0 && launched >= self.last_ray {
            self.stop();
        }
    }

    pub(crate) fn expect(&self, rays: u64) {
        self.total_rays.store(rays, Relaxed);
    }
}
