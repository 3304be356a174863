//! Optical surfaces, and the two ways in which a plugin writes one.
//!
//! A [`Surface`] works on a whole batch, but nobody has to write that by hand:
//! - [`PerRay`] makes a surface from plain scalar code ([`ScalarShape`]: one ray in, one intersection out, early return
//!   allowed); [`SagShape`] asks for even less, only a sag;
//! - [`Kernel`] makes a surface from branch-free code ([`KernelShape`]) that the compiler vectorizes for every instruction set.
//!
//! Both clip at the clear semi-diameter, refract or reflect, and count the rays lost.

mod bend;
mod by_batch;
mod from_sag;
mod kernel;
mod per_ray;
mod phase;
mod plane;
mod sag;
mod search;

pub use from_sag::FromSag;
pub use kernel::{Hit, Kernel, KernelShape, Near, Ray, Real};
pub use per_ray::{Bending, Intersection, PerRay, ScalarShape};
pub use phase::BentRay;
pub use plane::Plane;
pub use sag::SagShape;
pub use search::nearest_crossing;

use crate::RayBatch;
use std::sync::Arc;

/// The action of a surface on a ray that hits it inside its clear aperture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Refract by Snell's law, from the medium before to the one after.
    Refract,
    /// Reflect the ray.
    Reflect,
    /// Leave the ray alone, as at a stop or an image plane.
    Pass,
}

/// Refractive index of one medium per ray, and its inverse, so that no kernel has to divide.
#[derive(Clone, Copy, Debug)]
pub struct IndexColumns<'a> {
    /// Refractive index.
    pub n: &'a [f64],
    /// One over the index.
    pub inverse: &'a [f64],
}

/// Direction of travel along the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Travel {
    /// From the object to the imager.
    Forward,
    /// From the imager to the object.
    Backward,
}

/// The place of a surface in the system, as the lens describes it to the surface.
#[derive(Clone, Copy, Debug)]
pub struct Interface<'a> {
    /// Number of the surface, from 1; losses are counted under it.
    pub number: u32,
    /// Distance along z (mm) from the vertex of the surface traced before to the vertex of this surface. The rays arrive in the
    /// frame of the surface traced before.
    pub shift_mm: f64,
    /// Square of the clear semi-diameter, mm^2; infinity clips nothing.
    pub clip_radius2_mm2: f64,
    /// Action of this surface on rays.
    pub action: Action,
    /// Direction in which the batch travels.
    pub travel: Travel,
    /// Medium from which the rays come.
    pub before: IndexColumns<'a>,
    /// Medium which the rays enter.
    pub after: IndexColumns<'a>,
}

/// A surface of a lens. Its frame has the vertex at the origin and +z toward the imager.
pub trait Surface: Send + Sync + std::fmt::Debug {
    /// Sag at a point, mm from the vertex plane; `None` where the surface does not reach.
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64>;

    /// Curvature at the vertex along x and y, 1/mm, for paraxial optics.
    fn vertex_curvature_per_mm(&self) -> (f64, f64);

    /// Power for paraxial optics, 1/mm, in the x-z and in the y-z section, between media of these refractive indices:
    /// n' u' = n u - power h. For a mirror `n_after` is `-n_before`, as usual in lens design. The default follows from Snell's law
    /// and the curvature at the vertex.
    fn paraxial_power_per_mm(&self, n_before: f64, n_after: f64) -> (f64, f64) {
        let (x, y) = self.vertex_curvature_per_mm();
        ((n_after - n_before) * x, (n_after - n_before) * y)
    }

    /// Returns whether this is the aperture stop, which bends no light and whose size sets the f-number.
    fn is_stop(&self) -> bool {
        false
    }

    /// Returns whether the surface acts differently at different azimuths although its sag is round, as a ruled grating does.
    fn is_directional(&self) -> bool {
        false
    }

    /// Returns whether the surface draws random numbers ([`crate::numbers::RayNumbers`]), for example to scatter or split a share
    /// of the light. Light may then leave in another direction than it does without random numbers. The search for rays that pass
    /// a lens therefore ends at this surface.
    fn draws(&self) -> bool {
        false
    }

    /// Returns whether [`Surface::interact`] records in the batch how far each living ray traveled and by which angle it was
    /// deflected ([`way_mm`](crate::batch::WeightColumns::way_mm), [`versine`](crate::batch::WeightColumns::versine)). If it does not,
    /// code that needs these values computes them from positions and directions before and after.
    fn records_intersection(&self) -> bool {
        false
    }

    /// Returns whether the surface adds to the optical path of rays; see [`Surface::phase_mm`].
    fn has_phase(&self) -> bool {
        false
    }

    /// Optical path (mm) that the surface adds to a ray in addition to index times distance; the same for light that runs back
    /// along the ray. Surfaces that refract by Snell's law or reflect add none. A surface that deflects light by another law must
    /// add some, or wavefronts behind it are wrong: along the surface, n' d' - n d is the gradient of the added path (order times
    /// wavelength times position across the lines for a grating). Facets and other steps of a shape that refracts add none
    /// either, because their geometry accounts for the path.
    fn phase_mm(&self, _ray: &BentRay) -> f64 {
        0.0
    }

    /// Returns this surface with all lengths multiplied by `factor`: a ray that meets it `factor` times as far out is deflected
    /// by the same angle. `None` if the surface cannot be scaled. What depends on wavelengths, such as the line spacing of a
    /// grating, stays as it is.
    fn scaled(&self, _factor: f64) -> Option<Arc<dyn Surface>> {
        None
    }

    /// Moves the living rays of the batch onto this surface and bends them. Rays arrive in the frame of the surface traced before
    /// and leave in the frame of this one. A ray that ends gets the cause and the number of this surface. Works in either
    /// direction of travel. Returns how many rays ended here.
    fn interact(&self, rays: &mut RayBatch, interface: &Interface<'_>) -> usize;
}
