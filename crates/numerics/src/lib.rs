//! Mathematics that knows no physics and gives the same bits on every machine, at every vector width.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod convolve;
pub mod formula;
pub mod isa;
pub mod linear;
pub mod math;
pub mod normal;
pub mod poisson;
pub mod table;
