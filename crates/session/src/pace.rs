//! How fast a render goes on, and how long it will take.

use crate::Control;

/// How far a render is.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// Rays launched so far.
    pub rays: u64,
    /// Rays in all; 0 before the render knows.
    pub total_rays: u64,
    /// Since it began.
    pub rays_per_second: f64,
    /// By what is left to do, or until the time is up; `None` before anything is known.
    pub seconds_left: Option<f64>,
}

impl Pace {
    /// After so many `seconds`, with `most_s` until the time is up.
    #[must_use]
    pub fn of(control: &Control, seconds: f64, most_s: Option<f64>) -> Self {
        let (rays, total_rays) = (control.rays(), control.total_rays());
        let rays_per_second = if seconds > 0.0 { rays as f64 / seconds } else { 0.0 };
        let by_work = (rays > 0 && total_rays >= rays).then(|| (total_rays - rays) as f64 / rays_per_second);
        let seconds_left = match (by_work, most_s) {
            (Some(work), Some(clock)) => Some(work.min(clock)),
            (work, clock) => work.or(clock),
        };
        Self { rays, total_rays, rays_per_second, seconds_left }
    }

    /// Share of the rays that were launched.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        if self.total_rays > 0 { self.rays as f64 / self.total_rays as f64 } else { 0.0 }
    }
}
