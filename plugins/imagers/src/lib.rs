//! The built-in imagers: frames of pixels in the image plane, which may be shifted, tilted or curved.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod balance;
mod detector;
mod film;
mod formats;
mod params;
mod placement;
mod plane;
mod plates;
pub mod sensor;
mod spectral;
mod xyz;

pub use detector::{DetectorParams, DetectorPlane};
pub use film::{FilmPlane, FilmPlaneParams};
pub use formats::{FORMATS, Format, format_named};
pub use params::{CoverParams, Curvature, LowPassParams};
pub use placement::{FrameShape, Placement};
pub use plane::{MAX_PIXELS, MAX_SIDE_PX, Plane};
pub use plates::{Plate, Plates};
pub use spectral::{Bands, SpectralParams, SpectralPlane};
pub use xyz::{XyzParams, XyzPlane, XyzResponse};
