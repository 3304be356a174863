//! What an optical engineer asks of a lens: rays in, figures out.
//!
//! - [`trace`]: rays as CSV through a lens, the door through which any other program can be compared
//!   with this one;
//! - [`focus`]: what an image point is sharp for;
//! - [`info`]: first-order figures, pupils and prescription, for a program and for a person.

pub mod focus;
pub mod info;
mod light;
pub mod trace;

pub use light::Light;
