//! The tests of this crate as its users see it: one program, so that what they need is linked once.

mod hostile;
mod packages;
mod patents;
