//! Describes in words which losses of a lens are counted, as shown beside every T-number. Counts of lost rays are in [`spectra_core::loss`].

use crate::{Coating, LayerKind, Lens};
use spectra_core::surface::Action;
use spectra_glass::{AbsorptionSubstitute, Medium};

/// Loss above which a warning says that an assumed absorption darkens a lens, stops.
const DARK_STOPS: f64 = 1.0;

impl Lens {
    /// Describes in words which losses at coatings and in glass are counted, and which of them are assumed, such as `bare
    /// (assumed for 1927), glass absorbs`.
    #[must_use]
    pub fn losses(&self) -> String {
        let refracts = |e: &&crate::Element| e.action == Action::Refract && e.medium_before != e.medium_after;
        let own = self.elements.iter().filter(refracts).filter(|e| e.coating.is_some()).count();
        let all = self.elements.iter().filter(refracts).count();
        let mut coating = match own {
            0 => self.coating.describe(),
            _ if own == all => "each surface coated as stated".to_owned(),
            _ => format!("{}, {own} of {all} surfaces as stated", self.coating.describe()),
        };
        if self.coating_assumed && own < all {
            coating += &self.year.map_or(" (assumed: no year is stated)".to_owned(), |y| format!(" (assumed for {y})"));
        }
        let apart = match self.elements.iter().filter(|e| e.separation.is_some()).count() {
            0 => String::new(),
            1 => ", cement separated at 1 surface".to_owned(),
            many => format!(", cement separated at {many} surfaces"),
        };
        let soiled = self.layer_words().map_or(String::new(), |words| format!(", {words}"));
        format!("{coating}, {}{apart}{soiled}", self.absorption_words())
    }

    /// Describes the layers on surfaces, and on how many: `haze on 8 surfaces`; `None` if there are none.
    fn layer_words(&self) -> Option<String> {
        let on = |soil: LayerKind| {
            let many = self
                .elements
                .iter()
                .filter(|e| e.layers.iter().any(|layer| layer.soil == soil && layer.scattered > 0.0))
                .count();
            (many > 0).then(|| format!("{} on {many} surface{}", soil.key(), if many == 1 { "" } else { "s" }))
        };
        let words: Vec<String> =
            [LayerKind::Haze, LayerKind::Dust, LayerKind::Scratches].into_iter().filter_map(on).collect();
        (!words.is_empty()).then(|| words.join(", "))
    }

    /// Describes whether glass absorbs, and for how many glasses the absorption is known.
    fn absorption_words(&self) -> String {
        if !self.absorption {
            return "no absorption".to_owned();
        }
        let glasses = self.media.iter().filter(|m| !matches!(m.medium, Medium::Air | Medium::Vacuum));
        let known: Vec<bool> = glasses.map(|m| m.medium.absorption(self.year).is_some()).collect();
        let (all, clear) = (known.len(), known.iter().filter(|known| !**known).count());
        let parts = [(self.substituted_absorption().len(), "from a similar glass"), (clear, "unknown, taken as clear")];
        let parts: Vec<String> =
            parts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} of {all} {what}")).collect();
        match (all, parts.is_empty()) {
            (0, _) => "no glass".to_owned(),
            (_, true) => "glass absorbs".to_owned(),
            (_, false) => format!("glass absorbs (transmittances: {})", parts.join(", ")),
        }
    }

    /// Returns the medium whose assumed absorption takes most light on the axis, and the glass whose absorption is assumed for
    /// it. The number is the total loss by all assumed absorptions at the reference line, in stops. `None` if this loss is below
    /// one stop, or if glass does not absorb.
    #[must_use]
    pub fn darkened_by_assumption(&self) -> Option<(&str, AbsorptionSubstitute, f64)> {
        let nm = self.reference_nm;
        let mut stops = vec![0.0; self.media.len()];
        for element in &self.elements {
            let at = element.medium_after;
            let assumed = self.media[at].medium.absorption(self.year).filter(|absorption| absorption.lender.is_some());
            let k = assumed.and_then(|absorption| absorption.extinction.at(nm)).unwrap_or(0.0);
            stops[at] += 4e6 * std::f64::consts::PI * k / nm * element.thickness_mm.abs() / std::f64::consts::LN_2;
        }
        let all: f64 = stops.iter().sum();
        let (at, _) = stops.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
        let lender = self.media[at].medium.absorption(self.year)?.lender?;
        (self.absorption && all >= DARK_STOPS).then(|| (self.media[at].label.as_str(), lender, all))
    }

    /// Returns whether the lens is treated as free of losses at surfaces and in glass.
    #[must_use]
    pub fn is_lossless(&self) -> bool {
        let ideal = |e: &crate::Element| e.coating.as_ref().unwrap_or(&self.coating) == &Coating::Ideal;
        let clean = self.elements.iter().flat_map(|e| &e.layers).all(|layer| layer.scattered == 0.0);
        let whole = self.elements.iter().all(|e| e.separation.is_none());
        clean && whole && !self.absorption && self.elements.iter().filter(|e| e.action == Action::Refract).all(ideal)
    }
}
