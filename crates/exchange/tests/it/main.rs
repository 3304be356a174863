//! Integration tests of this crate through its public API, in one program so that dependencies are linked once.

mod hostile;
mod packages;
mod patents;
