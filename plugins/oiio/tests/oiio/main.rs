//! Integration tests under a name of their own, so that `.ci/run` can build them once more with the feature.

#![cfg(feature = "oiio")]

#[cfg(target_os = "linux")]
#[path = "../../../../crates/pictures/tests/cost/mod.rs"]
mod cost;
mod foreign;
#[cfg(target_os = "linux")]
mod foreign_memory;
mod limits;
