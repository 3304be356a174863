//! The coating of each surface of a lens, and the media whose absorption is taken from a similar glass.

use crate::{Coating, Element, Lens, LensMedium};
use spectra_glass::AbsorptionSubstitute;

impl Lens {
    /// Returns the coating of an element: its own coating, or else the coating of the lens. A cemented surface between two
    /// glasses without a coating of its own is bare, unless the coating of the lens is `ideal`.
    #[must_use]
    pub fn coating_of(&self, element: &Element) -> Coating {
        match (&element.coating, &self.coating) {
            (Some(own), _) => own.clone(),
            (None, all @ (Coating::Ideal | Coating::Bare)) => all.clone(),
            (None, _) if !self.is_gas(element.medium_before) && !self.is_gas(element.medium_after) => Coating::Bare,
            (None, all) => all.clone(),
        }
    }

    /// Returns the coating of the faces of a prism: its own coating, or else the coating of the lens.
    pub fn solid_coating_of(&self, element: &Element) -> Coating {
        element.coating.as_ref().unwrap_or(&self.coating).clone()
    }

    /// Lists the media whose absorption is taken from another glass: the label of each medium, and that glass. They are listed
    /// whether or not absorption is switched on.
    #[must_use]
    pub fn substituted_absorption(&self) -> Vec<(&str, AbsorptionSubstitute)> {
        let lender = |m: &LensMedium| m.medium.absorption(self.year)?.lender;
        self.media.iter().filter_map(|m| Some((m.label.as_str(), lender(m)?))).collect()
    }

    /// Puts this coating on all surfaces, replacing their own coatings.
    #[must_use]
    pub fn with_coating(mut self, coating: Coating) -> Self {
        self.coating = coating;
        self.coating_assumed = false;
        for e in &mut self.elements {
            e.coating = None;
        }
        self
    }
}
