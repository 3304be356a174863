//! Scattering by haze, dust and scratches on surfaces.
//!
//! Each is a thin layer on the side of the surface with the lower index. There light is stopped, or its direction makes a step ([`Lobe`]),
//! or it continues unchanged. A tracer traces one of two kinds of light: light that no layer scatters, which is only dimmed and needs no
//! random numbers, or light that is scattered at least once.
//!
//! A step changes the direction cosines along the surface, each multiplied by the index. It depends neither on the direction nor on the
//! place, so the etendue is kept and both directions of travel have the same weights. If light meets the layer before the glass, the
//! transmission of the coating is evaluated again for the direction behind the step, so that both directions of travel give a path the
//! same weight.

mod layer;
mod lobe;
mod params;

pub use layer::{Layer, LayerKind, Shares, which};

pub use lobe::{Lobe, Pattern, Run};
pub use params::{DustForm, HazeForm, ScratchesForm, read_layers};

use crate::{Element, Lens};
use spectra_core::surface::Action;

impl Lens {
    /// Returns whether haze, dust or scratches on any surface of the lens scatter light.
    #[must_use]
    pub fn scatters(&self) -> bool {
        self.elements.iter().flat_map(|e| &e.layers).any(|layer| layer.scattered > 0.0)
    }

    /// Returns whether the lens scatters light only by haze, whose light has no rings or streaks.
    #[must_use]
    pub fn scatters_smoothly(&self) -> bool {
        let is_smooth = |layer: &Layer| layer.scattered <= 0.0 || matches!(layer.lobe, Lobe::Harvey { .. });
        self.scatters() && self.elements.iter().flat_map(|e| &e.layers).all(is_smooth)
    }

    /// Puts this layer on all outer surfaces, where glass or a mirror meets a gas. Other layers of the same kind are removed from
    /// all surfaces.
    #[must_use]
    pub fn with_layer(mut self, layer: &Layer) -> Self {
        for at in 0..self.elements.len() {
            self.elements[at].layers.retain(|own| own.soil != layer.soil);
        }
        self.add_layer(layer);
        self
    }

    /// Puts a layer on all outer surfaces that have no layer of its kind.
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
