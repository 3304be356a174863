//! Test charts that the program draws.
//!
//! A chart is a list of vector shapes, later ones on top, each in one [`Ink`]. There is no raster, so edges are sharp at any
//! magnification. A grid over the chart lists the shapes that may cover each of its cells: most points need one lookup in it,
//! the others test a few shapes exactly.
//!
//! Lengths are millimeters on the chart: origin at the center, +x to the right as a person sees the upright chart, +y up. A
//! chart has the proportions of its design and any width; everything scales with the width. Figures printed on a chart are
//! therefore not lengths: line widths per picture height (LW/PH) count the black and white lines that fit into the height of
//! the chart.

mod catalog;
mod cell;
mod designs;
mod drawing;
mod font;
mod grid;
mod ink;
mod shape;
mod test_chart;

pub use catalog::{CHARTS, ChartEntry, ChartError, OWN_PATCHES, chart, own_patches};
pub use ink::NO_INK;
pub use ink::{Ink, PATCHES};
pub use test_chart::{Chart, Landmark};

#[cfg(test)]
mod pictures;
#[cfg(test)]
mod tests;
