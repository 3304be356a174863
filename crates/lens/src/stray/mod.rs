//! Stray light: what is left of light that leaves the order of the surfaces.
//!
//! Between two surfaces lies a gap: a closed room, walled by both surfaces and by the barrel, the cone from rim to rim. A particle of
//! light walks from wall to wall. At a surface of glass it is reflected or goes on, by chance, as Fresnel's equations and the coating
//! have it for unpolarized light; on the barrel, on what lies outside of a clear aperture, and on the blades of a stop it is absorbed
//! or scattered evenly (by Lambert's law) as paint does; the imager reflects as a mirror and as a screen. Nothing goes by the order of
//! the elements: the next wall is the nearest one.
//!
//! Walks run either way, with the same chances, and know nothing of the tracer.

mod chance;
mod room;
mod walk;

pub use chance::Chance;
pub use room::{Interior, StrayError};
pub use walk::{Particle, StrayLedger, Walker};

/// What reflects light inside a lens and camera beside glass, as parts from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrayMatter {
    /// Diffuse reflectance of barrel, rims, edges of glass, blades, and of the camera around the imager.
    pub paint: f64,
    /// Diffuse reflectance of the imager.
    pub imager: f64,
    /// What it reflects as a mirror; with `imager` at most 1.
    pub imager_mirror: f64,
}

/// Diffuse reflectance of matte black paint unless something else is stated: flat black paints for optical instruments reflect some
/// 4 to 5 % of visible light (J. L. Marshall et al., "Characterization of the reflectivity of various black materials", Proc. SPIE
/// 9147, 91474F, 2014).
pub const BLACK_PAINT: f64 = 0.04;

impl Default for StrayMatter {
    /// Matte black paint, and an imager that reflects nothing.
    fn default() -> Self {
        Self { paint: BLACK_PAINT, imager: 0.0, imager_mirror: 0.0 }
    }
}
