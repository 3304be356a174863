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
//! A point shares its rays out evenly over the area of that shape. The weight of each is the solid
//! angle of its share, area times cosine over distance squared: so the estimate has no bias, whatever
//! the shape, and light is counted equally per solid angle.

mod front;
mod nodes;
mod probe;
mod rear;
mod search;
mod shape;
mod table;

pub use front::{AimRegion, FrontPupil};
pub use rear::RearPupil;
pub use table::AimPattern;

use crate::{Lens, Travel};

/// Whether any surface states a size, so that there is something to aim at.
#[must_use]
pub fn has_sizes(lens: &Lens, travel: Travel) -> bool {
    search::Sphere::around(lens, travel).is_some()
}
