//! The object point in focus at an image point, by real rays.

mod conjugate;

pub use conjugate::{Conjugate, conjugate};
