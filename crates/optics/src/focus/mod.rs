//! Best focus by real rays: for the smallest spot or the highest contrast.

mod rings;
mod search;

pub use search::{Criterion, FocusSearch};
