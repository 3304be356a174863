//! Optical path that a surface adds to a ray in addition to its geometric path.

use glam::DVec3;

/// A ray that a surface has bent, as passed to [`Surface::phase_mm`](super::Surface::phase_mm). Points and directions are in
/// the frame of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BentRay {
    /// Point where the ray meets the surface, mm.
    pub point: DVec3,
    /// Unit direction in front of the surface.
    pub before: DVec3,
    /// Unit direction behind the surface.
    pub after: DVec3,
    /// Wavelength in air, nm.
    pub wavelength_nm: f64,
    /// Refractive index in front of the surface.
    pub n_before: f64,
    /// Refractive index behind the surface; for a mirror the index in front of it.
    pub n_after: f64,
    /// Distance (mm), measured against the light, from the vertex to the paraxial image that the elements in front form of the
    /// axial point in focus. Negative if light converges to a point behind the surface; infinite if it is parallel. Only an ideal
    /// lens needs it, since no lens is ideal for all distances at once.
    pub object_mm: f64,
}
