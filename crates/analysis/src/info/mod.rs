//! A lens in figures.

mod field;
mod mounts;
mod report;
mod table;

pub use field::{FieldReport, LimitReport};
pub use mounts::{MOUNTS, Mount, MountReport, cleared};
pub use report::{LensReport, SurfaceReport};
