//! Test charts drawn by the program.
//!
//! A chart is a list of vector shapes, later ones on top, each in one [`Ink`]; no raster stands behind it, so
//! an edge is an edge at any magnification. A grid over the chart knows which shapes can matter
//! where: most points are answered by one look at it, the others ask a few shapes exactly.
//!
//! Lengths are millimetres on the chart: origin at the center, +x to the right as a person sees the
//! upright chart, +y up. A chart has the proportions of its design and any width; everything scales with
//! it. Figures printed on a chart therefore do not name lengths: line widths per picture height
//! (LW/PH) count lines, black and white, that fit into the height of the chart.

mod catalogue;
mod cell;
mod designs;
mod drawing;
mod font;
mod grid;
mod ink;
mod shape;
mod sheet;

pub use catalogue::{CHARTS, ChartEntry, ChartError, OWN_PATCHES, chart, own_patches};
pub use ink::NO_INK;
pub use ink::{Ink, PATCHES};
pub use sheet::{Chart, Landmark};

#[cfg(test)]
mod pictures;
#[cfg(test)]
mod tests;
