//! Measurements on a picture file: the light that it records.
//!
//! - [`Measured`]: the picture with its colors, its size on the film and its exposure time, as far as the file states them;
//! - [`Summary`]: power, luminous flux, illuminance, colors that screens cannot show;
//! - [`QuantityMap`]: one quantity at each pixel, drawn as a view ([`view()`]) or sampled along a line ([`Cut`]); [`color()`] draws the colors;
//! - [`Area`]: the mean of a rectangle, with its spectrum if bands were recorded;
//! - [`Difference`]: a comparison of two pictures.

mod area;
mod bands;
mod color;
mod compare;
mod curve;
mod cut;
mod measured;
mod quantity_map;
mod summary;
mod view;

pub use area::{Area, Rectangle};
pub use bands::Band;
pub use color::color;
pub use compare::{Difference, Differs, compare};
pub use curve::curve;
pub use cut::{Cut, CutLine};
pub use measured::{Colors, Measured, NotMeasured, Unit};
pub use quantity_map::{Quantity, QuantityMap};
pub use summary::{ChannelFigures, Illuminance, OutOfGamut, Summary};
pub use view::{Scale, clipping, view};
