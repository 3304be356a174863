//! Tells surfaces that meet a gas from cemented surfaces between two glasses.

use crate::{Element, Lens, Separation};
use spectra_core::surface::Action;

/// A medium of a lower index counts as a gas. A surface between two other media is cemented and has no coating.
const GAS_INDEX: f64 = 1.05;

impl Lens {
    /// Puts this separation into all cemented surfaces, replacing the separation that they state. If the separation has a depth,
    /// which is measured from the edge, surfaces without a semi-diameter are skipped. Returns the lens and the number of changed
    /// surfaces.
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

    /// Whether an element is a cemented surface between two glasses.
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
