//! Built-in models from RGB to a spectrum.

mod basis;
mod fraunhofer;
mod gaussians;

pub use basis::Basis;
