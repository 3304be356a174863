//! The plane perpendicular to the axis: windows, stops and the openings of matte boxes.

use super::{Hit, KernelShape, Ray, Real};

/// The plane z = 0; as a stop it only clips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plane {
    stop: bool,
}

impl Plane {
    /// Creates a refracting plane surface.
    #[must_use]
    pub fn refracting() -> Self {
        Self { stop: false }
    }

    /// Creates the plane of the aperture stop.
    #[must_use]
    pub fn stop() -> Self {
        Self { stop: true }
    }
}

impl KernelShape for Plane {
    #[inline(always)]
    fn hit<R: Real, const FORWARD: bool>(&self, ray: Ray<R, FORWARD>) -> Hit<R> {
        let n = ray.direction[2];
        // A ray parallel to the plane never meets it, so 0 is made negative.
        Hit { distance: -ray.position[2] / n, cosine: n, valid: ray.along(n) - R::constant(f64::MIN_POSITIVE) }
    }

    #[inline(always)]
    fn normal<R: Real>(&self, _: [R; 3]) -> [R; 3] {
        [R::constant(0.0), R::constant(0.0), R::constant(1.0)]
    }

    fn sag_mm(&self, _: f64, _: f64) -> Option<f64> {
        Some(0.0)
    }

    fn scaled(&self, _factor: f64) -> Option<Self> {
        Some(*self)
    }

    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        (0.0, 0.0)
    }

    fn is_stop(&self) -> bool {
        self.stop
    }
}
