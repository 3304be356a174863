//! Which surfaces meet a gas, and which lie between two glasses.

use crate::{Element, Lens, Separation};
use spectra_core::surface::Action;

/// A medium of a lower index is a gas: a surface between two others is cemented, and no coating lies in it.
const GAS_INDEX: f64 = 1.05;

impl Lens {
    /// The same lens with this separation in all its cemented surfaces, whatever they state; those without a semi-diameter have no
    /// edge from which one of some depth could begin. Says in how many.
    #[must_use]
    pub fn with_separation(mut self, separation: &Separation) -> (Self, usize) {
        let mut many = 0;
        for at in 0..self.elements.len() {
            let e = &self.elements[at];
            if self.is_cemented(e) && (separation.depth_mm.is_none() || e.semi_diameter_mm.is_some()) {
                self.elements[at].separation = Some(separation.clone());
                many += 1;
            }
        }
        (self, many)
    }

    pub(crate) fn is_gas(&self, medium: usize) -> bool {
        self.index(medium, self.reference_nm) < GAS_INDEX
    }

    /// Whether an element is a surface between two glasses.
    pub(crate) fn is_cemented(&self, e: &Element) -> bool {
        e.action == Action::Refract
            && e.medium_before != e.medium_after
            && e.solid.is_none()
            && !e.surface.is_directional()
            && !e.surface.draws()
            && !self.is_gas(e.medium_before)
            && !self.is_gas(e.medium_after)
    }
}
