//! Built-in color models, which turn RGB values into spectra.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod basis;
mod fraunhofer;
mod gaussians;
mod named;
mod primaries;
mod smooth;

pub use basis::Basis;
