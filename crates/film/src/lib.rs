//! Exposure frames, film stocks, development and display.
//!
//! An imager records linear exposure, channel by channel. This crate turns it into a picture:
//!
//! - [`stock`]: spectral sensitivity, curves and structure of a film, from a data file;
//! - [`develop`]: the order of development, and the effects that a film has in it;
//! - [`curve`]: density over log exposure; [`emulsion`]: exposure to amounts of silver or dye;
//! - [`scatter`], [`halation`] before the curve, [`adjacency`], [`grain`] after it: effects of a film that involve more than one place;
//! - [`optics`]: the lens through which a developed film is printed, scanned or projected;
//! - [`deposit`]: spectral transmittance of silver and dyes;
//! - [`mod@print`]: a black-and-white negative on paper; [`positive`]: any film on a print stock, as a scan, or projected;
//! - [`display`]: absolute XYZ to a screen, with automatic exposure as one explicit step.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod adjacency;
mod cache;
mod cells;
mod cube;
pub mod curve;
pub mod deposit;
pub mod develop;
pub mod display;
pub mod emulsion;
pub mod grain;
pub mod halation;
mod lookup;
pub mod optics;
pub mod positive;
pub mod print;
pub mod push;
pub mod raster;
pub mod scatter;
pub mod stock;
pub mod viewing_options;
