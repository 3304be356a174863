//! The tests of this crate as its users see it: one program, so that what they need is linked once.

mod color;
mod grain;
mod halation;
mod optics;
mod ortho_plus;
mod positive;
mod scatter;
mod stock_files;
mod stocks;
