//! Tests of this crate's public interface, in one program so that dependencies are linked once.

mod algebra;
mod bad_tables;
mod illuminants;
mod lamps;
mod schema;
mod terms;
mod written;
