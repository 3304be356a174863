//! Exposure frames, film stocks, development, display and picture files.
//!
//! What an imager records is linear exposure, channel by channel. From there:
//!
//! - [`stock`]: what a film sees and how it answers, from a data file;
//! - [`curve`]: density over log exposure; [`develop`]: exposure to density; [`mod@print`]: the negative's positive;
//! - [`display`]: absolute XYZ to a screen, with automatic exposure as one explicit step;
//! - [`mod@write`]: OpenEXR of the exposure, PNG and TIFF of the picture.

mod convolve;
pub mod curve;
pub mod develop;
pub mod display;
pub mod grain;
pub mod halation;
mod lookup;
pub mod print;
pub mod raster;
pub mod scatter;
pub mod stock;
pub mod write;
