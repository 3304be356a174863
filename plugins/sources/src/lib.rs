//! Built-in light sources.

mod beam;
pub mod chart;
mod chart_source;
mod flat;
mod frame;
mod layers;
mod lazy;
mod palette;
mod picture;
mod point;
mod white;
