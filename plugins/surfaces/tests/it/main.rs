//! The tests of this crate as its users see it: one program, so that what they need is linked once.

mod closed_forms;
mod common;
mod laws;
mod parameters;
mod properties;
mod reference;
mod tiers;
