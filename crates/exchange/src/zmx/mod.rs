//! Zemax OpticStudio's `.zmx`, sequential mode.
//!
//! A file is lines of a keyword of four letters and values: first those of the system, then one block a surface
//! (`SURF n`), then merit function, tolerances and configurations. The meaning of records and surface types is that of
//! the OpticStudio user manual (chapters Sequential Surfaces, Apertures, Coordinate Break).

mod known;
mod read;
mod record;
mod shape;
mod surface;
mod system;
#[cfg(test)]
mod tests;
mod write;

pub use read::read;
pub use write::{Written, encode, write};
