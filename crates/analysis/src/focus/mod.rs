//! What is in focus, by real rays.

mod conjugate;

pub use conjugate::{Conjugate, conjugate};
