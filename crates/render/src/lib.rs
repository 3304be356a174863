//! Renders scenes by forward and backward light transport, with exact sums.
//!
//! **Work.** Work is divided into units, each a pure function of (scene, seed, unit). Their results are added as integers. The sums are
//! therefore the same, bit for bit, whatever the order of the units and the number of threads. A stop in between does not change what was
//! finished.
//!
//! **Estimators.** An [`Estimator`] estimates the exposure or a part of it: `backward`, `forward`, `ghosts`, `glare`, `scatter`. Each
//! divides a span of samples into units of its own, has sums and a scale of its own, and states the value of a unit of its sums. The
//! exposure is the sum of all estimators in a fixed order. If the source has bright lights and it pays, the lights are traced forward, with
//! a wavelength density of their own, and the rest backward. Both directions estimate the same exposure in the same units;
//! `tests/it/directions.rs` compares them.
//!
//! **Stopping and continuing.** [`Done`] states which samples are in the sums: all below a number, and a set of units of one further span.
//! Light can therefore be stopped, saved, loaded and continued, and has the bits of a run without a stop. The renderer refuses to go beyond
//! random numbers that are laid out in strata for a fixed number of samples.
//!
//! **Noise.** If a scene limits the noise (`render.noise`), each kind of light has two parts with independently scrambled numbers, whose
//! difference tells the noise (`parts.rs`). After each round, tiles whose blocks are clean get no more samples. The decisions rest on exact
//! sums, so they are the same however the work was divided.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod backward;
mod block_noise;
mod blocks;
mod check_pixels;
mod control;
mod diffracted;
mod done;
mod error;
mod estimator;
mod estimators;
mod finite_check;
mod footprint;
mod footprint_sums;
mod forward;
mod ghosts;
mod landing;
mod layers;
mod light;
mod light_file;
mod memory;
mod meter;
mod noise;
mod non_finite;
mod options;
mod parts;
mod passes;
mod pilot;
mod pipeline;
mod renderer;
mod rendering;
mod response;
mod scattered_light;
mod spots;
mod star_trial;
mod sums;
mod tiles;
mod tolerance;
mod trial;
mod veil;
mod warnings;
mod workers;

pub use control::Control;
pub use diffracted::Diffracted;
pub use done::{Done, Units};
pub use error::RenderError;
pub use estimator::{Estimator, Scratch, UnitResult};
pub use ghosts::{GhostPath, LightLedger};
pub use landing::Landing;
pub use light::Light;
pub use memory::{bytes, fits, memory_needed};
pub use noise::Noise;
pub use non_finite::{NonFinite, Step};
pub use options::{GhostRays, RenderOptions, Traced};
pub use pipeline::Pipeline;
pub use renderer::Renderer;
pub use rendering::{GhostNoise, Rendering};
pub use spectra_core::workers::{SingleThread, Workers};
pub use spectra_optics::Effort;
pub use sums::ExactSums;
pub use warnings::percent;
pub use workers::Threads;
