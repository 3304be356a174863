//! Lens prescriptions: surfaces, media, apertures, coatings and layers, first-order optics, and focusing by the maker's focusing laws.
//!
//! A [`Lens`] holds what a lens file states. The frame of a lens has its origin at the vertex of the first surface and z along the light.
//! The frame of the image plane has z = 0 in that plane, and the lens lies at negative z.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod aperture;
mod cemented;
mod coated;
pub mod coating;
mod cover;
mod element;
mod element_reader;
mod first_order;
mod focus;
mod glass_checks;
mod group;
mod imager;
mod lens;
mod losses;
mod matte_box;
mod misalignment;
pub mod onion;
mod origin;
mod pose;
mod prescription;
mod prism;
mod reverse;
mod scaled;
pub mod scatter;
mod schema;
mod separation;
mod shape_checks;
pub mod solid;
mod stated_medium;
mod surface_file;
mod symmetry;

pub use aperture::read as read_apertures;
pub use aperture::{Aperture, ApertureEntry, ApertureForm, ApertureShape, Iris, Mask, Opening};
pub use coating::{
    Coating, CoatingEntry, CoatingForm, MeasuredCoating, Reflectance, Stack, StackLayer, StatedCoating, Transmittance,
    read_coating, read_stated_coating,
};
pub use element::Element;
pub use first_order::{FirstOrder, Section};
pub use focus::{FocusError, FocusLaw, FocusTable, GroupTravel};
pub use group::Group;
pub use lens::{Lens, LensMedium};
pub use matte_box::{MATTE_BOX, MatteBox};
pub use misalignment::Misalignment;
pub use onion::OnionRings;
pub use origin::Rims;
pub use pose::{AxisBreak, Displacement, Pose};
pub use prescription::{lens_schema, load, parse, unknown_group};
pub use reverse::ReverseError;
pub use scaled::ScaleError;
pub use scatter::{DustForm, HazeForm, Layer, LayerKind, Lobe, Pattern, Run, ScratchesForm, read_layers};
pub use schema::{aperture_keys, coating_keys, surface_keys};
pub use separation::{Separation, SeparationForm, read_separation};
pub use solid::{Solid, SolidError};
