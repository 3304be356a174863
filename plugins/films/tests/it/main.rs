//! The tests of this crate as its users see it: one program, so that what they need is linked once.

mod frame;
mod granularity;
mod halation;
mod laws;
mod modulation;
mod stock;
mod three_strip;
