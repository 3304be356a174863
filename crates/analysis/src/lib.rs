//! Analysis of lenses and pictures: traced rays, first-order figures, ghosts, veiling glare, drawings and measurements.
//!
//! - [`trace`]: traces rays given as CSV through a lens, so that any other program can be compared with this one;
//! - [`info`]: first-order figures, pupils and prescription, for programs and for people;
//! - [`focus`]: the object point that is in focus at a given image point;
//! - [`fan`]: the rays of a field point that pass the lens, as a drawing shows them;
//! - [`ghosts`]: light that two or four surfaces reflect, path by path;
//! - [`glare`]: veiling glare, the part of an extended white field that a lens spreads over a black object;
//! - [`draw`]: a section of a lens as a figure, with rays in the colors of their wavelengths;
//! - [`figure`]: figures of spectra, their colors and glasses;
//! - [`picture`]: measurements on a rendered picture: light, colors, views, cuts, differences;
//! - [`terms`]: products of spectra as sums of Gaussian terms.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod analysis_light;
pub mod draw;
pub mod fan;
pub mod figure;
pub mod focus;
pub mod ghosts;
pub mod glare;
pub mod info;
pub mod picture;
pub mod terms;
pub mod trace;

pub use analysis_light::AnalysisLight;
