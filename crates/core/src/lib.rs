//! The vocabulary of the spectral camera: rays in batches, stage traits, registry, typed parameters.
//!
//! Every plugin depends on this crate and needs no other. Mathematical functions that give the same bits on every machine are
//! re-exported from `spectra-numerics`.
//!
//! # Conventions
//! - Lengths are in millimetres, wavelengths in nanometres, angles in radians, times in seconds. A bare `f64` that
//!   crosses a public border carries its unit in its name.
//! - +z runs from the object toward the imager, +y is up. A radius of curvature is positive where its centre lies at larger z.
//! - A lens's frame has its origin at the vertex of the first surface; a surface's own frame has it at that surface's vertex.
//! - Everything that travels with light does so in batches ([`RayBatch`]), so a call through a trait object costs nothing per ray.
//! - Random numbers, files and the instruction set reach a stage only through its arguments.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod batch;
pub mod cover;
pub mod frame;
pub mod loss;
pub mod names;
pub mod numbers;
pub mod one_layer;
pub mod params;
pub mod prelude;
pub mod quantity;
pub mod registry;
pub mod resources;
pub mod shutter;
pub mod sink;
pub mod spectral;
pub mod stage;
pub mod surface;
pub mod view;
pub mod workers;

pub use batch::RayBatch;
pub use glam;
pub use isa::Isa;
pub use loss::{Loss, LossCounts};
pub use spectra_numerics::{isa, linear, math};
