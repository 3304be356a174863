//! Optical path that a surface adds to a ray beside the way that the ray goes.

use glam::DVec3;

/// A ray that a surface has bent, as [`Surface::phase_mm`](super::Surface::phase_mm) looks at it. Points and directions are in the
/// frame of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BentRay {
    /// Where the ray meets the surface, mm.
    pub point: DVec3,
    /// Unit direction in front of the surface.
    pub before: DVec3,
    /// Unit direction behind it.
    pub after: DVec3,
    /// Wavelength in air, nm.
    pub wavelength_nm: f64,
    /// Refractive index in front of the surface.
    pub n_before: f64,
    /// Refractive index behind it; of a mirror that in front.
    pub n_after: f64,
    /// Distance, mm, against the light from the vertex to the point of the axis that the lens is focused on, as paraxial optics images it
    /// through what stands before the surface. Negative where light converges to a point behind the surface; infinite where it is
    /// parallel. Only an ideal lens needs it: no lens is ideal for all distances at once.
    pub object_mm: f64,
}
