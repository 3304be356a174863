//! A matte box: a rectangular opening in front of the lens.

use crate::aperture::{Aperture, ApertureShape};
use crate::pose::{AxisBreak, Displacement};
use crate::{Element, Lens};
use spectra_core::surface::{Action, Kernel, Plane};
use std::sync::Arc;

/// The `kind` of the element that stands for a matte box.
pub const MATTE_BOX: &str = "matte-box";

/// A matte box: a rectangular opening in front of the lens, centered on the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatteBox {
    /// Distance of the opening in front of the first vertex, in mm; positive.
    pub distance_mm: f64,
    /// Full width of the opening, mm.
    pub width_mm: f64,
    /// Full height of the opening, mm.
    pub height_mm: f64,
}

impl Lens {
    /// Puts a matte box in front of the lens. It becomes the first element, clips light in both directions, and is seen by every
    /// search for a pupil. Other elements and the origin stay where they are; the numbers of the other elements increase by one.
    #[must_use]
    pub fn behind_matte_box(mut self, opening: &MatteBox) -> Self {
        let (half_width_mm, half_height_mm) = (0.5 * opening.width_mm, 0.5 * opening.height_mm);
        let mut element = Element::new(MATTE_BOX, Arc::new(Kernel(Plane::refracting())), 0, 0);
        element.action = Action::Pass;
        element.breaks = vec![AxisBreak { displacement: Displacement::NONE, thickness_mm: -opening.distance_mm }];
        element.thickness_mm = opening.distance_mm;
        element.semi_diameter_mm = Some((half_width_mm * half_width_mm + half_height_mm * half_height_mm).sqrt());
        element.apertures = vec![Aperture {
            shape: ApertureShape::Rectangle { half_width_mm, half_height_mm },
            center_mm: [0.0; 2],
            obscures: false,
        }];
        self.elements.insert(0, element);
        for group in &mut self.groups {
            group.elements = group.elements.start + 1..group.elements.end + 1;
            group.about += 1;
        }
        self.arrange();
        self
    }
}
