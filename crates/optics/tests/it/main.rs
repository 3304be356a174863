//! The tests of this crate from a user's point of view: one program, so that dependencies are linked once.

mod chance;
mod glasses;
mod onion;
mod passing;
mod paths;
mod phases;
mod polarization;
mod prisms;
mod scatter;
mod separation;
mod stray;
mod thin_films;
mod workers;
