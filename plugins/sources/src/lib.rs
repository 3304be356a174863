//! The built-in light sources.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod beam;
pub mod chart;
mod chart_source;
mod deferred_source;
mod frame;
mod layers;
mod palette;
mod picture;
mod plane_source;
mod point;
mod split_source;
mod sun;
mod white;
