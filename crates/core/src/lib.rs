//! The vocabulary of the spectral camera: rays in batches, stage traits, registry, typed parameters.
//!
//! This crate depends on no other crate of the workspace; every plugin depends on it. Units are
//! millimetres, nanometres, radians and seconds; +z runs from the object toward the imager, +y is
//! up; a radius is positive where its centre lies at larger z.

pub mod batch;
pub mod frame;
pub mod isa;
pub mod loss;
pub mod math;
pub mod names;
pub mod numbers;
pub mod one_layer;
pub mod params;
pub mod picture_file;
pub mod prelude;
pub mod registry;
pub mod resources;
pub mod spectral;
pub mod stage;
pub mod surface;

pub use batch::RayBatch;
pub use glam;
pub use isa::Isa;
pub use loss::{Loss, LossCounts};
