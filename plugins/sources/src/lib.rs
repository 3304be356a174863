//! The built-in light sources.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod beam;
pub mod chart;
mod chart_source;
mod flat;
mod frame;
mod halves;
mod layers;
mod lazy;
mod palette;
mod picture;
mod point;
mod sun;
mod white;
