//! The vocabulary of the spectral camera: rays in batches, stage traits, registry, typed parameters.
//!
//! Every plugin depends on this crate and needs no other. Mathematical functions that give the same bits on every machine are
//! re-exported from `spectra-numerics`.
//!
//! # Conventions
//! - Lengths are in millimeters, wavelengths in nanometers, angles in radians, times in seconds. A bare `f64` in a public
//!   interface carries its unit in its name.
//! - +z runs from the object toward the imager, +y is up. A radius of curvature is positive if its center lies at larger z.
//! - The frame of a lens has its origin at the vertex of the first surface; the frame of a surface has it at the vertex of that
//!   surface.
//! - Geometry is computed in `f64`. Rays are passed in batches ([`RayBatch`]: structure of arrays behind accessors), so a call through
//!   a trait object costs nothing per ray. Losses are counted by cause and surface.
//! - Random numbers, files and the instruction set reach a stage only through its arguments.
//! - The band of light is 350 to 830 nm unless a scene states another: film is sensitive below 380 nm ([`spectral::BAND`]).
//! - Light is absolute: radiance in W m^-2 sr^-1 nm^-1, exposure in lux seconds. A film channel is scaled so that the stock's
//!   reference illuminant gives its photometric lux seconds. Exposure stays linear until film curves act, once, on the whole frame.
//! - Picture files show the upright, unmirrored subject; coordinates on the film are turned by half a turn ([`frame::FrameSize`]).
//! - Keys of files are kebab-case without units. Keys of JSON figures are snake_case with units.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod batch;
pub mod cover;
pub mod frame;
pub mod frame_view;
pub mod grain_noise;
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
pub mod workers;

pub use batch::RayBatch;
pub use glam;
pub use isa::Isa;
pub use loss::{Loss, LossCounts};
pub use spectra_numerics::{isa, linear, math};
