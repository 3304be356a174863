//! The built-in kinds of optical surfaces.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod biconic;
mod conic;
mod cylinder;
mod even_asphere;
mod grating;
mod odd_asphere;
mod plane;
mod sag_table;
mod shared;
mod sphere;
mod thin_lens;
mod tilted_plane;
mod toroid;
mod zernike;

pub use biconic::Biconic;
pub use conic::Conic;
pub use cylinder::{Cylinder, CylinderAxis};
pub use even_asphere::EvenAsphere;
pub use grating::Grating;
pub use odd_asphere::OddAsphere;
pub use plane::Plane;
pub use sag_table::SagTable;
pub use sphere::Sphere;
pub use thin_lens::ThinLens;
pub use tilted_plane::TiltedPlane;
pub use toroid::Toroid;
pub use zernike::{Zernike, ZernikeOrdering};
