//! Tests of the public interface of this crate. They form one program, so that their dependencies are linked once.

mod closed_forms;
mod common;
mod laws;
mod parameters;
mod properties;
mod reference;
mod tiers;
