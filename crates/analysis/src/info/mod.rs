//! A lens in figures.

mod field;
mod media;
mod mounts;
mod report;
mod table;

pub use field::{FieldReport, LimitReport};
pub use media::AssumedMedium;
pub use mounts::{MOUNTS, Mount, MountReport, cleared};
pub use report::{LensReport, SurfaceReport};
