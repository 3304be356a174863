//! Zemax OpticStudio's `.zmx`, sequential mode.
//!
//! A file is lines of a keyword of four letters and values: first those of the system, then one block a surface
//! (`SURF n`), then merit function, tolerances and configurations. The meaning of records and surface types is that of
//! the OpticStudio user manual (chapters Sequential Surfaces, Apertures, Coordinate Break).

mod known;
mod numbers;
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

/// A note in files that are written here: the beam that the file states is that which rims let pass, and its stop has no size of its own.
const OPEN_STOP: &str = "The stop is open: the rims of the lens limit the light.";
