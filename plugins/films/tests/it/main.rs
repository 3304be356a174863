//! Tests of this crate's public interface, in one program so that dependencies are linked once.

mod film;
mod frame;
mod grain_noise;
mod granularity;
mod halation;
mod laws;
mod modulation;
mod stock;
mod three_strip;
