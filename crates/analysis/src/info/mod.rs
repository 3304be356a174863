//! A lens in figures.

mod report;
mod table;

pub use report::{LensReport, SurfaceReport};
