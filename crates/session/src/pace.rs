//! The speed of a render, and the time that it will take.

use crate::Control;

/// Progress of a render.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// Rays launched so far.
    pub rays: u64,
    /// Rays in all; 0 before the render knows.
    pub total_rays: u64,
    /// Average rate since the render began, rays per second.
    pub rays_per_second: f64,
    /// Estimated time to the end, s: until all rays are traced or the time limit is reached. `None` before anything is known.
    pub seconds_left: Option<f64>,
}

impl Pace {
    /// Computes the progress after `seconds`, with `most_s` seconds left until the time limit.
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

    /// Fraction of the rays launched so far, 0 to 1.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        if self.total_rays > 0 { self.rays as f64 / self.total_rays as f64 } else { 0.0 }
    }
}
