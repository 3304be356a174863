//! The tests of this crate as its users see it: one program, so that what they need is linked once.

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
