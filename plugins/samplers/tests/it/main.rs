//! Tests of every strategy: samples against density, estimates against quadrature, errors, and speed.

mod density;
mod errors;
mod extremes;
mod hero;
mod laws;
mod params;
mod speed;
mod terms;
mod unbiased;
mod world;
