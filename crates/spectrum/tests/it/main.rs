//! The tests of this crate as its users see it: one program, so that what they need is linked once.

mod algebra;
mod bad_tables;
mod illuminants;
mod lamps;
mod schema;
mod terms;
mod written;
