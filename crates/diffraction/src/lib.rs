//! Diffraction at the edge of the aperture.
//!
//! **Model.** Through a lens without aberrations, a point of light forms on film the squared transform of the opening, laid out in
//! direction cosines as seen from the point (Fraunhofer; M. Born and E. Wolf, "Principles of optics", 8.5). In that plane the f-number is 1
//! / (2 sin theta'), and the pattern is the squared transform of the opening at film distance over wavelength. No distance of a pupil is
//! needed. Openings are polygons: their transform is a sum over edges, in closed form, at any distance.
//!
//! **Opening.** [`Pupil`] finds the opening as seen from a place of the film, in direction cosines along the frame. Rays from there through
//! the lens without rims give a map from the stop to directions, fitted to the fifth degree. The edges of the blades are carried along this
//! map in short pieces, and the rims cut the result.
//!
//! **Core.** Within 16 wavelengths times f-number the pattern itself is integrated over pixels ([`PixelSpread`]). Farther out, the spike of
//! each edge and the pairs of edges at a corner are integrated in closed form ([`Wings`]). Kernels are made at the nodes of a grid of
//! zones, four across the frame, and blend into each other ([`Spread`]). Energy is exact by construction: the middle pixel gets what the
//! others leave of 1. Tests compare this middle with the pattern.
//!
//! **Aberrations.** Near the core the aberrations of the lens matter, too. There the wavefront, traced through the lens, gives the combined
//! effect of rays and edges ([`Wavefronts`], [`Wavefront`], `aberrated`).
//!
//! **Far.** From 0.6 of the core's radius on, light fades over to two other ways. Pixels whose spikes would be seen have them drawn as
//! lines of boxes to the edge of the frame (`star`). All other light, and what bent edges and the flanks of spikes send, is smooth and goes
//! over coarse cells.
//!
//! **Why not one transform of the frame.** A kernel out to the edge of the frame costs seconds per zone and channel. Zones that blend into
//! each other would show each spike twice. Lines cost time only where there are lamps.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod aberrated;
mod channel_light;
mod kernel;
mod polygon;
mod pupil;
mod spread;
mod star;
mod wavefront;
mod wings;

pub use channel_light::ChannelLight;
pub use kernel::PixelSpread;
pub use polygon::Polygon;
pub use pupil::{Pupil, Wavefronts};
pub use spread::{LensView, Spread, SpreadReport, star_of_pixel};
pub use wavefront::Wavefront;
pub use wings::{Fan, Wings};
