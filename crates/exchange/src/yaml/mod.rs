//! Lens files of this program: written from a prescription, and read back into one.

mod quote;
mod read;
mod write;

pub use read::read;
pub use write::write;
