//! Media that light travels in between two surfaces.

use std::sync::Arc;

use crate::air;
use crate::formula::ModelGlass;
use crate::glass::Glass;
use crate::lines::{D, LineTriple};

/// A medium between two surfaces, with its index relative to air.
#[derive(Clone, Debug, PartialEq)]
pub enum Medium {
    /// Air, whose index is 1 by definition.
    Air,
    /// Vacuum, whose index is 1 / n_air, with n_air for air at 20 C and 101 325 Pa.
    Vacuum,
    /// A medium with the same index at every wavelength; also a medium that is held at its stated index.
    Constant(f64),
    /// A glass known by an index and an Abbe number.
    Model(ModelGlass),
    /// A glass of a catalogue.
    Glass(Arc<Glass>),
}

impl Medium {
    /// Creates a model glass from nd and Vd; `None` unless nd >= 1 and Vd >= 0. A Vd of 0 means no dispersion.
    #[must_use]
    pub fn from_nd_vd(nd: f64, vd: f64) -> Option<Medium> {
        ModelGlass::new(nd, vd, LineTriple::FDC).map(Medium::Model)
    }

    /// Refractive index at a wavelength in nm, relative to air, computed by the medium's formula.
    #[must_use]
    pub fn index(&self, wavelength_nm: f64) -> f64 {
        match self {
            Medium::Air => 1.0,
            Medium::Vacuum => 1.0 / air::index(wavelength_nm, air::CATALOGUE_AIR),
            Medium::Constant(n) => *n,
            Medium::Model(model) => model.index(wavelength_nm),
            Medium::Glass(glass) => glass.index(wavelength_nm),
        }
    }

    /// Shortest and longest wavelength of the data, nm; `None` if there is no limit.
    #[must_use]
    pub fn range_nm(&self) -> Option<(f64, f64)> {
        match self {
            Medium::Glass(glass) => Some(glass.range_nm),
            Medium::Air | Medium::Vacuum | Medium::Constant(_) | Medium::Model(_) => None,
        }
    }

    /// Returns whether the medium has data from `min_nm` to `max_nm`, so that no index is extrapolated.
    #[must_use]
    pub fn covers(&self, min_nm: f64, max_nm: f64) -> bool {
        self.range_nm().is_none_or(|(min, max)| min <= min_nm && max_nm <= max)
    }

    /// Returns this medium with one index for all wavelengths: `stated_nd` if the prescription states it, otherwise its own index
    /// at the d line. Air stays air.
    #[must_use]
    pub fn at_stated_nd(&self, stated_nd: Option<f64>) -> Medium {
        match self {
            Medium::Air => Medium::Air,
            _ => Medium::Constant(stated_nd.unwrap_or_else(|| self.index(D.wavelength_nm))),
        }
    }

    /// Abbe number for three lines; infinite without dispersion.
    #[must_use]
    pub fn abbe_number(&self, lines: LineTriple) -> f64 {
        lines.abbe_number(|w| self.index(w))
    }

    /// Internal transmittance of `thickness_mm` at a wavelength in nm; `None` if it is not known. Air, vacuum and media known by
    /// an index alone absorb no light.
    #[must_use]
    pub fn internal_transmittance(&self, wavelength_nm: f64, thickness_mm: f64) -> Option<f64> {
        match self {
            Medium::Glass(glass) => glass.internal_transmittance(wavelength_nm, thickness_mm),
            Medium::Air | Medium::Vacuum | Medium::Constant(_) | Medium::Model(_) => Some(1.0),
        }
    }

    /// Name of the medium in reports: `air`, `SCHOTT/N-BK7`, `n 1.5168 V 64.17`.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Medium::Air => "air".to_owned(),
            Medium::Vacuum => "vacuum".to_owned(),
            Medium::Constant(n) => format!("n {n}"),
            Medium::Model(model) => format!("n {} V {}", model.index_mid(), model.abbe_number()),
            Medium::Glass(glass) => glass.full_name(),
        }
    }
}

impl From<Glass> for Medium {
    fn from(glass: Glass) -> Medium {
        Medium::Glass(Arc::new(glass))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vacuum_is_thinner_than_air() {
        let n = Medium::Vacuum.index(550.0);
        // Standard air (15 C) has 1.000 277 835 there; 20 C thins it by 288.15 / 293.15.
        assert!((n - 1.0 / (1.0 + 2.778_35e-4 * 288.15 / 293.15)).abs() < 2e-8, "{n}");
        assert!(Medium::Vacuum.covers(200.0, 3000.0));
    }

    #[test]
    fn held_at_the_stated_index() {
        let model = Medium::from_nd_vd(1.64329, 47.72).expect("a glass");
        assert_eq!(model.at_stated_nd(Some(1.6433)), Medium::Constant(1.6433));
        let Medium::Constant(n) = model.at_stated_nd(None) else { panic!("not held") };
        assert!((n - 1.64329).abs() < 1e-15);
        assert_eq!(Medium::Air.at_stated_nd(Some(1.5)), Medium::Air);
    }
}
