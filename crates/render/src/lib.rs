//! Rendering: forward and backward light transport with exact sums.
//!
//! Work is cut into units that are pure functions of (scene, seed, unit). Their results are added as
//! integers, so neither the order, nor the number of threads, nor a stop in between changes a bit of
//! what was finished.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod backward;
mod blame;
mod control;
mod diffracted;
mod done;
mod error;
mod estimator;
mod footprint;
mod forward;
mod ghosts;
mod haze;
mod judge;
mod landing;
mod layers;
mod light;
mod memory;
mod meter;
mod no_number;
mod noise;
mod pilot;
mod pipeline;
mod remarks;
mod renderer;
mod rendering;
mod response;
mod saved;
mod spots;
mod spreader;
mod sums;
mod tiles;
mod veil;
mod workers;

pub use control::Control;
pub use diffracted::Diffracted;
pub use done::{Done, Units};
pub use error::RenderError;
pub use estimator::{Estimator, Scratch, Unit};
pub use ghosts::{GhostPath, GhostRays, LightLedger};
pub use landing::Landing;
pub use light::Light;
pub use memory::{bytes, fits, memory_needed};
pub use no_number::{NoNumber, Step};
pub use noise::Noise;
pub use pipeline::Pipeline;
pub use remarks::percent;
pub use renderer::Renderer;
pub use rendering::{GhostNoise, Rendering};
pub use spectra_core::workers::{Alone, Workers};
pub use spectra_lens::Effort;
pub use sums::ExactSums;
pub use workers::Threads;
