//! Stray light: light that leaves the order of the surfaces, traced by random walks.
//!
//! **Model.** An [`Interior`] is a row of rooms. A room is the gap between two surfaces, walled by both of them and by the barrel, the cone
//! from rim to rim; the last room is the camera, with the imager as its far wall. A [`Walker`] takes a particle of light from wall to wall.
//! The next wall is the nearest one; nothing depends on the order of the elements. At a glass surface the particle is reflected or
//! transmitted by chance, by Fresnel's equations and the coating for unpolarized light. On the barrel, outside a clear aperture, and on the
//! blades of a stop it is absorbed or scattered by Lambert's law, as by paint. The imager reflects as a mirror and as a screen.
//!
//! **Directions.** Walks go from the imager to the front or from the front to the imager, with the same probabilities. Off the imager a
//! third of them goes by Lambert's law, a third toward the exit pupil and a third toward the last rim, with weights that compensate for it.
//! The k-th number of a walk is a hash of (seed, walk, k).
//!
//! **Check.** Walks share only apertures and coatings with the tracer, so each is a test of the other (`crates/optics/tests/it/stray.rs`).
//!
//! **Limits.** Lenses with mirrors, prisms, gratings, surfaces that scatter, or bent axes do not form such rooms and are refused. Plates in
//! front of the imager are ignored.

mod room;
mod walk;
mod walk_numbers;

pub use room::{Interior, StrayError};
pub use walk::{Particle, StrayLedger, Walker};
pub use walk_numbers::WalkNumbers;

/// Reflectances inside a lens and camera, except those of glass: fractions from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrayReflectances {
    /// Diffuse reflectance of the paint on barrel, rims, edges of glass and blades, and in the camera around the imager.
    pub paint: f64,
    /// Diffuse reflectance of the imager.
    pub imager: f64,
    /// Mirror-like reflectance of the imager. The sum of `imager` and `imager_mirror` is at most 1.
    pub imager_mirror: f64,
}

/// Diffuse reflectance of matte black paint, used unless another value is stated. Flat black paints for optical instruments
/// reflect about 4 to 5 % of visible light (J. L. Marshall et al., "Characterization of the reflectivity of various black
/// materials", Proc. SPIE 9147, 91474F, 2014).
pub const BLACK_PAINT: f64 = 0.04;

impl Default for StrayReflectances {
    /// Returns matte black paint, and an imager that reflects nothing.
    fn default() -> Self {
        Self { paint: BLACK_PAINT, imager: 0.0, imager_mirror: 0.0 }
    }
}
