//! Light that haze, dust and scratches on surfaces scatter.
//!
//! What lies on a surface is a thin layer on its side of lower index: there light is stopped, or its direction makes a
//! step ([`Lobe`]), or it goes on. A [`crate::Tracer`] traces one of two kinds of light: what goes on everywhere, which is only
//! dimmed and needs no chance, or ([`crate::Tracer::scattering`]) what is scattered at least once.

mod layer;
mod lobe;
mod params;
mod trace;

pub use layer::{Layer, Soil};
pub(crate) use layer::{Shares, which};
pub use lobe::{Lobe, Pattern, Run};
pub use params::{DustForm, HazeForm, ScratchesForm, read_layers};
pub(crate) use trace::{Meeting, Place, dim, scatter};

use crate::{Element, Lens};
use spectra_core::surface::Action;

impl Lens {
    /// Whether anything on it scatters light.
    #[must_use]
    pub fn scatters(&self) -> bool {
        self.elements.iter().flat_map(|e| &e.layers).any(|layer| layer.scattered > 0.0)
    }

    /// Whether all that scatters light on it is haze, whose light has no rings or streaks.
    #[must_use]
    pub fn scatters_smoothly(&self) -> bool {
        let is_smooth = |layer: &Layer| layer.scattered <= 0.0 || matches!(layer.lobe, Lobe::Harvey { .. });
        self.scatters() && self.elements.iter().flat_map(|e| &e.layers).all(is_smooth)
    }

    /// The same lens with this layer on all outer surfaces, where glass or a mirror meets a gas, whatever they state of its kind.
    #[must_use]
    pub fn with_layer(mut self, layer: &Layer) -> Self {
        for at in 0..self.elements.len() {
            self.elements[at].layers.retain(|own| own.soil != layer.soil);
        }
        self.add_layer(layer);
        self
    }

    /// Puts a layer on all outer surfaces that state none of its kind.
    pub(crate) fn add_layer(&mut self, layer: &Layer) {
        for at in 0..self.elements.len() {
            let e = &self.elements[at];
            if self.is_outer(e) && !e.layers.iter().any(|own| own.soil == layer.soil) {
                self.elements[at].layers.push(layer.clone());
            }
        }
    }

    fn is_outer(&self, element: &Element) -> bool {
        let [before, after] = [element.medium_before, element.medium_after].map(|medium| self.is_gas(medium));
        match element.action {
            Action::Reflect => before,
            Action::Refract => {
                before != after
                    && element.solid.is_none()
                    && !element.surface.is_directional()
                    && !element.surface.draws()
            }
            Action::Pass => false,
        }
    }
}
