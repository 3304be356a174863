//! Lens prescriptions, tracing, first-order optics, focus and stop.
//!
//! A [`Lens`] is what a file states; a [`Tracer`] is a lens made ready for one band of light. Rays
//! enter a tracer in the frame of the lens (vertex of the first surface at the origin) and leave it
//! in the frame of the image plane (z = 0 there); backward it is the other way round.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod absorption;
mod aim;
mod aperture;
mod beam;
mod branches;
mod cemented;
mod coating;
mod cover;
mod element;
mod f_number;
mod field;
mod first_order;
mod focus;
mod group;
mod ledger;
mod lens;
mod losses;
mod matte_box;
mod misalignment;
mod misread;
mod onion;
mod origin;
mod path;
mod pencil;
mod pose;
mod prescription;
mod prism;
mod reflections;
mod reverse;
mod rims;
mod scaled;
mod scatter;
mod schema;
mod separation;
mod solid;
mod stray;
mod surface_file;
mod symmetry;
mod tracer;
mod transmission;

pub use aim::{AimPart, AimPattern, AimRegion, Effort, FrontPupil, RIM_EVERY, RearPupil, has_sizes};
pub use aperture::read as read_apertures;
pub use aperture::{Aperture, ApertureEntry, ApertureForm, Iris, Mask, Opening, Shape};
pub use beam::{Beam, ObjectPoint};
pub use branches::Branches;
pub use coating::{
    Coating, CoatingEntry, CoatingForm, MeasuredCoating, Reflectance, Stack, StackLayer, StatedCoating, Transmittance,
    read_coating, read_stated_coating,
};
pub use element::Element;
pub use f_number::{ApertureError, LimitingRim, MarginalRay};
pub use field::{ChiefRay, FieldLimit};
pub use first_order::{FirstOrder, Section};
pub use focus::{Criterion, FocusError, FocusLaw, FocusSearch, FocusTable, GroupTravel};
pub use group::Group;
pub use ledger::{Ledger, StepLedger};
pub use lens::{Lens, LensMedium};
pub use matte_box::{MATTE_BOX, MatteBox};
pub use misalignment::Misalignment;
pub use onion::OnionRings;
pub use origin::Rims;
pub use path::{Act, Path, PathError, PathStep};
pub use pose::{AxisBreak, Displacement, Pose};
pub use prescription::{lens_schema, load, parse, unknown_group};
pub use reflections::{FrontDisk, FrontOpening};
pub use reverse::ReverseError;
pub use scaled::ScaleError;
pub use scatter::{DustForm, HazeForm, Layer, Lobe, Pattern, Run, ScratchesForm, Soil, read_layers};
pub use schema::{aperture_keys, coating_keys, surface_keys};
pub use separation::{Separation, SeparationForm, read_separation};
pub use solid::{Solid, SolidError};
pub use spectra_core::surface::Travel;
pub use stray::{BLACK_PAINT, Chance, Interior, Particle, StrayError, StrayLedger, StrayMatter, Walker};
pub use tracer::{Indices, RayPath, Route, Tracer, Work};
