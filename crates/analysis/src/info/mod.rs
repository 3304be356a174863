//! Figures of a lens: first-order data, pupils, field, prescription, mounts, and comparisons of lenses.

mod compare;
mod illuminance;
mod lens_field;
mod lens_sheet;
mod media;
mod mounts;
mod report;

pub use compare::{Compared, Comparison};
pub use lens_field::{FieldReport, LimitReport, useful_field_rad};
pub use media::AssumedMedium;
pub use mounts::{Glass, MOUNTS, Mount, MountReport, cleared};
pub use report::{LensReport, SurfaceReport};
