//! Built-in imagers: flat frames in the image plane.

mod film;
mod formats;
mod params;
mod plane;
mod xyz;

pub use film::{FilmPlane, FilmPlaneParams};
pub use formats::{FORMATS, Format, format_named};
pub use plane::{MAX_PIXELS, MAX_SIDE_PX, Plane};
pub use xyz::{XyzParams, XyzPlane};
