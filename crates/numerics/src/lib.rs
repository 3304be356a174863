//! Mathematics without physics that gives the same bits on every machine and at every vector width.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod convolve;
pub mod formula;
pub mod hash;
pub mod isa;
pub mod linear;
pub mod math;
pub mod normal;
pub mod poisson;
pub mod table;
