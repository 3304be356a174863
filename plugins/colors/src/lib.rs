//! Built-in models from RGB to a spectrum.

mod basis;
mod fraunhofer;
mod gaussians;
mod primaries;
mod smooth;

pub use basis::Basis;
