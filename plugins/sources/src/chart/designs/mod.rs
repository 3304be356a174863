//! The designs of the charts, each in its own size.

mod color_checker;
mod grid;
mod parts;
mod patches;
mod resolution;
mod siemens;
mod slanted_edge;
mod star_field;
mod step_wedge;
mod text;
mod uniform;

pub(super) use color_checker::color_checker;
pub(super) use grid::grid;
pub(super) use patches::patches;
pub(super) use resolution::resolution;
pub(super) use siemens::siemens;
pub(super) use slanted_edge::slanted_edge;
pub(super) use star_field::star_field;
pub(super) use step_wedge::step_wedge;
pub(super) use text::text;
pub(super) use uniform::{gray_card, white};
