//! A lens in figures.

mod compare;
mod field;
mod mounts;
mod report;
mod table;

pub use compare::{Compared, Comparison};
pub use field::{FieldReport, LimitReport};
pub use mounts::{Glass, MOUNTS, Mount, MountReport, cleared};
pub use report::{Borrowed, LensReport, SurfaceReport};
