//! The tests of this crate as its users see it: one program, so that what they need is linked once.

#![cfg(feature = "oiio")]

#[cfg(target_os = "linux")]
#[path = "../../../../crates/pictures/tests/cost/mod.rs"]
mod cost;
mod foreign;
#[cfg(target_os = "linux")]
mod foreign_memory;
mod limits;
