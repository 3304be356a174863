//! Built-in models from RGB to a spectrum.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod basis;
mod fraunhofer;
mod gaussians;
mod named;
mod primaries;
mod smooth;

pub use basis::Basis;
