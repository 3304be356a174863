//! Zemax OpticStudio lens files, `.zmx`, in sequential mode.
//!
//! A file consists of lines with a keyword of four letters and values: first those of the system, then one block for each surface (`SURF
//! n`), then merit function, tolerances and configurations. Records and surface types have the meaning given in the OpticStudio user manual
//! (chapters Sequential Surfaces, Apertures, Coordinate Break).

mod keywords;
mod numbered_values;
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

/// Note in files written here: the stop has no size of its own, and the stated beam is the one that the rims let pass.
const OPEN_STOP: &str = "The stop is open: the rims of the lens limit the light.";
