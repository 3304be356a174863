//! Lens prescriptions, tracing, first-order optics, focus and stop.
//!
//! A [`Lens`] is what a file states; a [`Tracer`] is a lens made ready for one band of light. Rays
//! enter a tracer in the frame of the lens (vertex of the first surface at the origin) and leave it
//! in the frame of the image plane (z = 0 there); backward it is the other way round.

mod aim;
mod aperture;
mod coating;
mod element;
mod f_number;
mod first_order;
mod focus;
mod group;
mod lens;
mod pose;
mod prescription;
mod symmetry;
mod tracer;
mod transmission;

pub use aim::{FrontDisk, RearPupil};
pub use aperture::{Aperture, Iris, Mask, Opening, Shape};
pub use coating::{Coating, Transmittance, read_coating};
pub use element::Element;
pub use f_number::{ApertureError, MarginalRay};
pub use first_order::{FirstOrder, Section};
pub use focus::FocusError;
pub use group::Group;
pub use lens::{Lens, LensMedium};
pub use pose::{AxisBreak, Displacement, Pose};
pub use prescription::{load, parse};
pub use spectra_core::surface::Travel;
pub use tracer::{Indices, RayPath, Tracer, Work};
