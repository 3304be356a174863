//! Every strategy: its samples against its density, its estimates against quadrature, its errors, its speed.

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
