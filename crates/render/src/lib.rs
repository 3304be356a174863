//! Rendering: forward and backward light transport with exact sums.
//!
//! Work is cut into units that are pure functions of (scene, seed, unit). Their results are added as
//! integers, so neither the order, nor the number of threads, nor a stop in between changes a bit of
//! what was finished.

mod backward;
mod blame;
mod control;
mod error;
mod forward;
mod landing;
mod memory;
mod meter;
mod pipeline;
mod remarks;
mod renderer;
mod response;
mod sums;

pub use blame::{NoNumber, Step};
pub use control::Control;
pub use error::RenderError;
pub use landing::Landing;
pub use memory::{bytes, fits, memory_needed};
pub use renderer::{Renderer, Rendering};
