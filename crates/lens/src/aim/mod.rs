//! Where to aim rays so that few are wasted and none that could pass is forgotten.
//!
//! The light that passes a lens from one point crosses a small region: the real pupil, cut by every
//! rim on the way. On a fast lens it is a cat's eye off the axis, on a fisheye it moves toward the
//! front and turns to face the point. Both directions aim at it by the same means: points are sorted
//! into zones (the angle at which the point is seen from a reference point of the lens, its depth, and
//! its azimuth where the lens has no axis of revolution); each zone has a plane across its chief
//! direction, near the real pupil, and on it the ellipse or rectangle that holds everything that
//! passes. [`search`](FrontPupil::search) finds them by tracing.
//!
//! Light that a surface scatters leaves it in directions that no search finds. So only the way to the first such surface is
//! searched, from the side that the rays come from: what reaches it is aimed at, whatever becomes of it there.
//!
//! Inside of it, each zone has an outline of what passes, one for each zone of wavelength: a line around the pupil as it is
//! cut by rims, blades and drawings. Nearly all rays of a point are shared out evenly over the area of that outline, and the
//! few others over a ring around it: see [`outline`]. The weight of each is the solid angle of its share, area times cosine
//! over distance squared, so light is counted equally per solid angle, and the estimate has no bias while outline and ring hold
//! all that passes; random rays beyond the outline check that when it is made. From the film, core and rim of the two are aimed at apart:
//! see [`AimPart`].

mod aiming;
mod effort;
mod fan;
mod front;
mod lattice;
mod measure;
mod nodes;
mod outline;
mod part;
mod probe;
mod reach;
mod rear;
mod region;
mod search;
mod shape;
mod sphere;
mod stopped;
mod table;
mod task;

pub use aiming::AimPattern;
pub use effort::Effort;
pub use front::{AimRegion, FrontPupil};
pub use part::{AimPart, RIM_EVERY};
pub use rear::RearPupil;
pub(crate) use sphere::Sphere;

use crate::{Lens, Travel};

/// Whether any surface states a size, so that there is something to aim at.
#[must_use]
pub fn has_sizes(lens: &Lens, travel: Travel) -> bool {
    Sphere::around(lens, travel).is_some()
}
