//! Separated cement: a gap of air between two glasses, over a part of a cemented surface.
//!
//! The gap is about as thin as a wavelength, so it is a layer of index 1 in which light interferes with itself. Where the gap is that
//! narrow, colored fringes appear. Beyond the angle of total reflection only light that tunnels passes. Rays continue as if the cement
//! held.

use crate::aperture::{Aperture, ApertureForm, read as read_apertures};
use crate::coating::Coating;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Deferred, Faults, Length, Params, Positive, StageNode};
use spectra_core::resources::Resources;

/// The key in a lens file for separated cement: a thin gap of air in a cemented surface.
pub const KEY: &str = "separation";
const NM_PER_MM: f64 = 1e6;

/// Cement that has separated: a gap of air between two glasses.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(inline)]
pub struct SeparationForm {
    /// Width of the gap of air, mm if bare, 1 nm to 100 um; with `depth`, the width at the edge.
    #[schemars(range(min = 0.000_001, max = 0.1))]
    gap: Positive<Length>,
    /// How far the gap reaches in from the edge of the surface, mm if bare. It narrows to nothing there, with Newton's rings on the way.
    /// If absent, the gap has the same width everywhere.
    depth: Option<Positive<Length>>,
    /// Where the gap is, written as for `haze`. All over the surface if absent.
    #[serde(rename = "where")]
    place: Option<Deferred<ApertureForm>>,
}

/// A gap of air in a cemented surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Separation {
    /// Width of the gap, nm; if it has a depth, the width at the clear edge of the surface.
    pub gap_nm: f64,
    /// Depth (mm) from the clear edge inward at which the gap has narrowed to 0. `None` if the gap has the same width everywhere.
    pub depth_mm: Option<f64>,
    /// Where the gap is: all over the surface if empty, otherwise where all of these apertures let light pass.
    pub places: Vec<Aperture>,
}

impl Separation {
    /// Returns the width of the gap (nm) at a point of the surface (x, y in mm); 0 where the cement holds. `semi_diameter_mm` is
    /// the semi-diameter of the surface.
    #[must_use]
    pub fn gap_nm(&self, [x_mm, y_mm]: [f64; 2], semi_diameter_mm: Option<f64>) -> f64 {
        let (Some(depth_mm), Some(edge_mm)) = (self.depth_mm, semi_diameter_mm) else { return self.gap_nm };
        let inward_mm = edge_mm - (x_mm * x_mm + y_mm * y_mm).sqrt();
        self.gap_nm * (1.0 - inward_mm / depth_mm).clamp(0.0, 1.0)
    }

    /// Returns the fraction of the light that meets the gap at a point of the surface (x, y in mm), and the gap as a coating.
    /// Returns `None` where the cement holds. `semi_diameter_mm` is the semi-diameter of the surface.
    pub fn at(&self, place: [f64; 2], semi_diameter_mm: Option<f64>) -> Option<(f64, Coating)> {
        let thickness_nm = self.gap_nm(place, semi_diameter_mm);
        let through = |aperture: &Aperture| aperture.transmittance(place[0], place[1], semi_diameter_mm);
        let part: f64 = if thickness_nm > 0.0 { self.places.iter().map(through).product() } else { 0.0 };
        (part > 0.0).then_some((part, Coating::Layer { index: 1.0, thickness_nm }))
    }

    /// Returns whether the region of the gap is symmetric about the axis.
    #[must_use]
    pub fn is_round(&self) -> bool {
        self.places.iter().all(Aperture::is_round)
    }
}

/// Reads a separation from a lens file.
///
/// # Errors
/// Faults if a key is wrong, each with its place.
pub fn read_separation(node: &StageNode, resources: &dyn Resources) -> Result<Separation, Faults> {
    let params = Params::section(node.node().clone(), node.path())?;
    let p: SeparationForm = params.parse()?;
    Ok(Separation {
        gap_nm: NM_PER_MM * p.gap.mm(),
        depth_mm: p.depth.map(|depth| depth.mm()),
        places: p.place.as_ref().map_or(Ok(Vec::new()), |node| read_apertures(node, resources))?,
    })
}
