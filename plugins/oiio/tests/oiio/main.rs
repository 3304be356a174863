//! The tests of this crate as its users see it, by a name of their own: `.ci/run` builds them once more with the feature.

#![cfg(feature = "oiio")]

#[cfg(target_os = "linux")]
#[path = "../../../../crates/pictures/tests/cost/mod.rs"]
mod cost;
mod foreign;
#[cfg(target_os = "linux")]
mod foreign_memory;
mod limits;
