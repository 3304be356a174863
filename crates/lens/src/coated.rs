//! The coating of each surface of a lens, and the media whose absorption is taken from a similar glass.

use crate::{Coating, Element, Lens, LensMedium};
use spectra_glass::AbsorptionSubstitute;

impl Lens {
    /// Returns the coating of an element: its own, or else the lens's. A lens coating other than `ideal` does not apply to a cemented
    /// surface between two glasses, which counts as bare.
    #[must_use]
    pub fn coating_of(&self, element: &Element) -> Coating {
        match (&element.coating, &self.coating) {
            (Some(own), _) => own.clone(),
            (None, all @ (Coating::Ideal | Coating::Bare)) => all.clone(),
            (None, _) if !self.is_gas(element.medium_before) && !self.is_gas(element.medium_after) => Coating::Bare,
            (None, all) => all.clone(),
        }
    }

    /// Returns the coating of the faces of a prism: its own, or else the lens's.
    pub fn solid_coating_of(&self, element: &Element) -> Coating {
        element.coating.as_ref().unwrap_or(&self.coating).clone()
    }

    /// Lists the media whose absorption is taken from another glass, each with its label and that glass. They are listed whether or not
    /// absorption is switched on.
    #[must_use]
    pub fn substituted_absorption(&self) -> Vec<(&str, AbsorptionSubstitute)> {
        let lender = |m: &LensMedium| m.medium.absorption(self.year)?.lender;
        self.media.iter().filter_map(|m| Some((m.label.as_str(), lender(m)?))).collect()
    }

    /// Puts this coating on all surfaces, replacing what they state.
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
