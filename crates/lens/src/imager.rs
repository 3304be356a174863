//! Adds the imager as a mirror behind a lens.

use crate::{Aperture, ApertureShape, Coating, Element, Lens, LensMedium, MeasuredCoating};
use spectra_core::surface::{Kernel, Plane};
use spectra_glass::Medium;
use std::sync::Arc;

impl Lens {
    /// Adds the imager as a mirror in the image plane, behind all other elements. Within a polygon (corners in mm, frame of the
    /// image plane) it reflects a fraction of the light and passes the rest. `reflectance` returns this fraction at a wavelength
    /// in nm.
    #[must_use]
    pub fn with_reflecting_imager(mut self, reflectance: impl Fn(f64) -> f64, corners_mm: Vec<[f64; 2]>) -> Self {
        let before = self.elements.last().map_or(0, |e| e.medium_after);
        // The medium behind the imager does not matter, except that it must be a different one.
        self.media.push(LensMedium { medium: Medium::Constant(1.5), stated_nd: None, label: "imager".to_owned() });
        let coating = Coating::Measured(Arc::new(MeasuredCoating::new(|nm| 1.0 - reflectance(nm))));
        let shape = ApertureShape::Polygon(corners_mm);
        self.elements.push(Element {
            coating: Some(coating),
            apertures: vec![Aperture { shape, center_mm: [0.0; 2], obscures: false }],
            pose: self.image_pose,
            ..Element::new("imager", Arc::new(Kernel(Plane::refracting())), before, self.media.len() - 1)
        });
        self
    }
}
