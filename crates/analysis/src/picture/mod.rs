//! A picture measured: what its file says of the light that is in it.
//!
//! - [`Measured`]: the picture with its colors, its size on the film and its exposure time, as far as the file says them;
//! - [`Summary`]: power, luminous flux, illuminance, colors that screens cannot show;
//! - [`Field`]: one quantity at each pixel, as a view ([`view()`]) or a cut ([`Cut`]), or its colors ([`color()`]);
//! - [`Area`]: the mean of a rectangle, with its spectrum where bands were recorded;
//! - [`Difference`]: two pictures against each other.

mod area;
mod bands;
mod color;
mod compare;
mod curve;
mod cut;
mod field;
mod measured;
mod summary;
mod view;

pub use area::{Area, Rectangle};
pub use bands::Band;
pub use color::color;
pub use compare::{Difference, Differs, compare};
pub use curve::curve;
pub use cut::{Cut, Way};
pub use field::{Field, Quantity};
pub use measured::{Colors, Measured, NotMeasured, Unit};
pub use summary::{ChannelFigures, Illuminance, Outside, Summary};
pub use view::{Scale, clipping, view};
