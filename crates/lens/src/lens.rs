//! A lens: surfaces along the axis, media between them, and where it comes from.

use spectra_core::surface::{Action, Surface};
use spectra_glass::Medium;
use std::sync::Arc;

/// A medium as the prescription names it.
#[derive(Clone, Debug)]
pub struct LensMedium {
    /// Its dispersion.
    pub medium: Medium,
    /// The index that the prescription states at its reference line, if it does.
    pub stated_nd: Option<f64>,
    /// How the file names it, such as `SCHOTT/BAF9` or `air`.
    pub label: String,
}

impl LensMedium {
    /// Air, index 1: glass catalogues state indices relative to it.
    #[must_use]
    pub fn air() -> Self {
        Self { medium: Medium::Air, stated_nd: Some(1.0), label: "air".to_owned() }
    }
}

/// One surface in its place.
#[derive(Clone, Debug)]
pub struct Element {
    /// Its `kind` in the file.
    pub kind: String,
    /// Shape and bending.
    pub surface: Arc<dyn Surface>,
    /// Vertex on the axis, mm from the first vertex.
    pub vertex_z_mm: f64,
    /// Distance to the next vertex, mm; of the last surface, to the image plane.
    pub thickness_mm: f64,
    /// Clear semi-diameter, mm; `None` clips nothing.
    pub semi_diameter_mm: Option<f64>,
    /// What it does to light.
    pub action: Action,
    /// Medium in front of it: index into [`Lens::media`].
    pub medium_before: usize,
    /// Medium behind it.
    pub medium_after: usize,
}

/// A lens.
#[derive(Clone, Debug)]
pub struct Lens {
    /// Name for people.
    pub name: String,
    /// Year of design, where known.
    pub year: Option<i32>,
    /// Patent and example, where known.
    pub patent: Option<String>,
    /// Maker, where known.
    pub maker: Option<String>,
    /// Where the figures come from.
    pub source: Option<String>,
    /// Doubts, and choices that were made.
    pub remark: Option<String>,
    /// Wavelength of the reference line, nm: focus and first order are meant there.
    pub reference_nm: f64,
    /// The surfaces, in the order of the light.
    pub elements: Vec<Element>,
    /// The media; number 0 is air.
    pub media: Vec<LensMedium>,
    /// What a person should know of the file: a glass that disagrees with the stated index, and so on.
    pub warnings: Vec<String>,
}

impl Lens {
    /// A lens without surfaces, of which nothing but the name is known; to be filled.
    #[must_use]
    pub fn empty(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            year: None,
            patent: None,
            maker: None,
            source: None,
            remark: None,
            reference_nm: spectra_glass::lines::D.wavelength_nm,
            elements: Vec::new(),
            media: vec![LensMedium::air()],
            warnings: Vec::new(),
        }
    }

    /// Number of the stop among the elements, if there is one.
    #[must_use]
    pub fn stop(&self) -> Option<usize> {
        self.elements.iter().position(|e| e.surface.is_stop())
    }

    /// Distance of the image plane from the first vertex, mm.
    #[must_use]
    pub fn image_z_mm(&self) -> f64 {
        self.elements.last().map_or(0.0, |e| e.vertex_z_mm + e.thickness_mm)
    }

    /// Distance of the image plane from the last vertex, mm.
    #[must_use]
    pub fn image_gap_mm(&self) -> f64 {
        self.elements.last().map_or(0.0, |e| e.thickness_mm)
    }

    /// The same lens with another distance from the last vertex to the image plane, mm.
    #[must_use]
    pub fn with_image_gap_mm(mut self, gap_mm: f64) -> Self {
        if let Some(last) = self.elements.last_mut() {
            last.thickness_mm = gap_mm;
        }
        self
    }

    /// The same lens with its stop set to this semi-diameter, mm.
    #[must_use]
    pub fn with_stop_semi_diameter_mm(mut self, semi_diameter_mm: f64) -> Self {
        if let Some(stop) = self.stop() {
            self.elements[stop].semi_diameter_mm = Some(semi_diameter_mm);
        }
        self
    }

    /// Index of refraction of medium `medium` at a wavelength, by its formula.
    #[must_use]
    pub fn index(&self, medium: usize, wavelength_nm: f64) -> f64 {
        self.media[medium].medium.index(wavelength_nm)
    }

    /// The largest stated clear semi-diameter, mm; `None` where no surface states one.
    #[must_use]
    pub fn largest_semi_diameter_mm(&self) -> Option<f64> {
        self.elements.iter().filter_map(|e| e.semi_diameter_mm).reduce(f64::max)
    }
}
