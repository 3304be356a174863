//! Rendering: forward and backward light transport with exact sums.
//!
//! Work is cut into units that are pure functions of (scene, seed, unit). Their results are added as
//! integers, so neither the order, nor the number of threads, nor a stop in between changes a bit of
//! what was finished.

mod backward;
mod control;
mod error;
mod forward;
mod pipeline;
mod renderer;
mod response;
mod sums;

pub use control::Control;
pub use error::RenderError;
pub use renderer::{Renderer, Rendering};
