//! What an optical engineer asks of a lens: rays in, figures out.
//!
//! - [`trace`]: rays as CSV through a lens, the door through which any other program can be compared
//!   with this one;
//! - [`info`]: first-order figures, pupils and prescription, for a program and for a person;
//! - [`focus`]: what an image point is sharp for;
//! - [`fan`]: the rays of a field that pass, as a drawing shows them;
//! - [`ghosts`]: light that two surfaces reflect, path by path;
//! - [`glare`]: how much of an extended white field a lens spreads over what should be black;
//! - [`draw`]: a lens as a figure, with rays in the colors of their wavelengths;
//! - [`figure`]: spectra, their colors, and glasses as figures;
//! - [`picture`]: a rendered picture measured: light, colors, views, cuts, differences.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod draw;
pub mod fan;
pub mod figure;
pub mod focus;
pub mod ghosts;
pub mod glare;
pub mod info;
mod light;
pub mod picture;
pub mod terms;
pub mod trace;

pub use light::Light;
