//! How a renderer is made ready.

use spectra_core::Isa;
use spectra_core::stage::WavelengthDensity;
use spectra_core::workers::{SingleThread, Workers};
use spectra_optics::Effort;
use spectra_scene::Direction;
use std::sync::Arc;

/// How a [`Renderer`](crate::Renderer) is made ready. The defaults render all light of the scene, on one thread.
#[derive(Clone)]
pub struct RenderOptions<'a> {
    /// Instruction set of all rays; the bits are the same on any.
    pub isa: Isa,
    /// A wavelength density that is already fitted to the scene; if `None`, one is fitted.
    pub density: Option<Arc<dyn WavelengthDensity>>,
    /// How closely pupils are searched and meters are read.
    pub effort: Effort,
    /// Workers that share the searches; the bits are the same on any.
    pub workers: &'a dyn Workers,
    /// The light that is rendered.
    pub traced: Traced,
    /// Whether the light itself is kept in a file that the scene does not name. `render.noise: auto` then ignores the grain.
    pub keeps_light: bool,
}

/// The light that a renderer traces.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Traced {
    /// All light, as the scene asks for it. Bright lights of the source ([`spectra_core::stage::Split`]) are traced forward and the rest
    /// backward if the scene says so; if it does not say, this is done when it pays.
    #[default]
    All,
    /// Straight and scattered light of the whole source in each of these directions, added up; neither ghosts nor glare.
    Directions(Vec<Direction>),
    /// Ghosts alone, with these rays, to measure them. Without a reflecting surface there is no light.
    Ghosts(GhostRays),
}

/// The way rays are shared out over the ghost paths and over the front of the lens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GhostRays {
    /// Shares rays out as a preceding search finds best.
    #[default]
    Found,
    /// Gives each path equally many rays, all over the front: the reference for the search.
    Even,
}

impl Default for RenderOptions<'_> {
    fn default() -> Self {
        Self {
            isa: Isa::detect(),
            density: None,
            effort: Effort::Full,
            workers: &SingleThread,
            traced: Traced::All,
            keeps_light: false,
        }
    }
}
