//! Optical surfaces, and the two tiers in which a plugin writes one.
//!
//! A [`Surface`] works on a whole batch. Nobody needs to write that by hand:
//! - [`PerRay`] turns plain scalar code ([`ScalarShape`]: one ray in, one intersection out, early
//!   return allowed) into a surface; [`SagShape`] asks even less, a sag;
//! - [`Kernel`] turns branch-free code ([`KernelShape`]) into a surface that the compiler vectorises
//!   for every instruction set.
//!
//! Both do the rest alike: clip at the clear semi-diameter, refract or reflect, count what is lost.

mod bend;
mod kernel;
mod per_ray;
mod sag;
mod search;

pub use kernel::{Hit, Kernel, KernelShape, Ray, Real};
pub use per_ray::{Bending, Intersection, PerRay, ScalarShape};
pub use sag::{FromSag, SagShape};
pub use search::nearest_crossing;

use crate::RayBatch;
use crate::isa::Isa;

/// What a surface does with a ray that meets it inside of its clear aperture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Snell's law, from the medium before to the one after.
    Refract,
    /// Mirror.
    Reflect,
    /// Nothing: a stop, an image plane.
    Pass,
}

/// Refractive index per ray of one medium, with its inverse: the kernels divide by neither.
#[derive(Clone, Copy, Debug)]
pub struct IndexColumns<'a> {
    /// Refractive index.
    pub n: &'a [f64],
    /// One over it.
    pub inverse: &'a [f64],
}

/// Sense of travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Travel {
    /// From the object to the imager.
    Forward,
    /// From the imager to the object.
    Backward,
}

/// What the lens tells a surface about its place.
#[derive(Clone, Copy, Debug)]
pub struct Interface<'a> {
    /// Number of the surface, from 1: losses are booked there.
    pub number: u32,
    /// The rays come in the frame of the surface traced before; its vertex plus this, along z, is this surface's vertex, mm.
    pub shift_mm: f64,
    /// Square of the clear semi-diameter, mm^2; infinity clips nothing.
    pub clip_radius2_mm2: f64,
    /// What happens there.
    pub action: Action,
    /// Sense in which the batch travels.
    pub travel: Travel,
    /// Medium that the rays come from, in the sense of travel.
    pub before: IndexColumns<'a>,
    /// Medium that they go to.
    pub after: IndexColumns<'a>,
}

/// A surface of a lens. Its own frame: vertex at the origin, +z toward the imager.
pub trait Surface: Send + Sync + std::fmt::Debug {
    /// Sag at a point, mm from the vertex plane; `None` where the surface does not reach.
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64>;

    /// Curvature at the vertex, 1/mm (x, y): what paraxial optics sees.
    fn vertex_curvature_per_mm(&self) -> (f64, f64);

    /// Power for paraxial optics, 1/mm (in the x-z and the y-z section), between media of these refractive indices:
    /// n' u' = n u - power h. A mirror is `n_after = -n_before`, as usual in lens design. By default what Snell's law
    /// makes of the curvature at the vertex.
    fn paraxial_power_per_mm(&self, n_before: f64, n_after: f64) -> (f64, f64) {
        let (x, y) = self.vertex_curvature_per_mm();
        ((n_after - n_before) * x, (n_after - n_before) * y)
    }

    /// Whether this is the aperture stop: it bends no light, and its size sets the f-number.
    fn is_stop(&self) -> bool {
        false
    }

    /// Whether it treats azimuths differently although its sag does not show it: a ruled grating.
    fn is_directional(&self) -> bool {
        false
    }

    /// Moves the living rays of the batch from the frame of the surface before onto this one, in
    /// its own frame, and bends them; those that end get cause and number. Works in either sense of
    /// travel. Returns how many ended here.
    fn interact(&self, rays: &mut RayBatch, interface: &Interface<'_>, isa: Isa) -> usize;
}
