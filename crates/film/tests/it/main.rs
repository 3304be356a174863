//! Integration tests of this crate in one program, so that dependencies are linked only once.

mod color;
mod grain;
mod halation;
mod optics;
mod ortho_plus;
mod positive;
mod scatter;
mod stock_files;
mod stocks;
