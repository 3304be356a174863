//! Real-ray optics of a lens: bundles of rays that pass it, and the figures that follow from them.
//!
//! An [`Optics`] is a [`Lens`](spectra_lens::Lens) made ready to trace. A [`Bundle`] finds which rays of a point pass the lens. From
//! bundles follow the marginal and the chief rays, the field, the f-number and the focus. [`FrontPupil`] and [`RearPupil`] are the tables
//! with which a renderer aims rays at the part of the lens that light passes.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod aim;
mod aperture_error;
mod beam;
mod bundle;
mod f_number;
mod field;
mod focus;
mod front_opening;
mod marginal;
mod optics;

pub use aim::{AimPart, AimPattern, AimRegion, Effort, FrontPupil, RIM_EVERY, RearPupil, has_sizes};
pub use aperture_error::{ApertureError, LimitingRim};
pub use beam::Beam;
pub use bundle::{Bundle, Extent, ObjectPoint, RayPattern, WindowLine};
pub use f_number::stop_down;
pub use field::{ChiefRay, FieldLimit};
pub use focus::{Criterion, FocusSearch};
pub use front_opening::{FrontDisk, FrontOpening};
pub use marginal::MarginalRay;
pub use optics::{Clipping, Optics};
