//! Built-in light sources.

pub mod chart;
mod chart_source;
mod flat;
mod palette;
mod picture;
mod point;
mod white;
