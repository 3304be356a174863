//! What the edge of the aperture does to light.
//!
//! A point of light through a lens without aberrations is on film the squared transform of the opening that light passes, laid out in
//! direction cosines as the point sees it (Fraunhofer; M. Born and E. Wolf, "Principles of optics", 8.5). Openings are polygons: their
//! transform is a sum over edges, in closed form, at any distance. Near the core of the pattern the aberrations of the lens count too: there
//! the wavefront, traced through the lens, says what rays and edges do together.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod aberrated;
mod kernel;
mod light;
mod polygon;
mod pupil;
mod spread;
mod star;
mod wave;
mod wings;

pub use kernel::PixelSpread;
pub use light::Light;
pub use polygon::Polygon;
pub use pupil::{Pupil, Waves};
pub use spread::{Account, Spread, View, brightest_star};
pub use wave::Wave;
pub use wings::{Fan, Wings};
