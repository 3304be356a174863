//! Scaling: multiplies all lengths of a lens by a factor, so that angles, f-numbers and glasses stay the same.

use crate::aperture::{Aperture, ApertureShape};
use crate::focus::GroupTravel;
use crate::pose::{AxisBreak, Displacement};
use crate::solid::Solid;
use crate::{Element, Lens};
use std::sync::Arc;

/// The reason why a lens cannot be scaled.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScaleError {
    /// A surface is of a kind that cannot be scaled: the surface's number, from 1, and its kind.
    #[error("surface {0} (`{1}`) does not say how it scales")]
    Surface(usize, String),
    /// A surface has a drawing as its aperture, which cannot be scaled: the surface's number, from 1.
    #[error("surface {0} has a drawing as its aperture, which is not scaled")]
    Drawing(usize),
}

impl Lens {
    /// Returns the lens with all its lengths multiplied by `factor` (above 0): radii, gaps, rims, apertures, displacements, and
    /// the travel of groups. Structures whose effect depends on the wavelength stay unchanged: coatings, gaps of air in cement,
    /// the lines of a grating, and onion rings.
    ///
    /// # Errors
    /// [`ScaleError`] if a surface or an aperture cannot be scaled.
    pub fn scaled(mut self, factor: f64) -> Result<Self, ScaleError> {
        for (at, element) in self.elements.iter_mut().enumerate() {
            scale_element(element, at + 1, factor)?;
        }
        for group in &mut self.groups {
            group.displacement = group.displacement.scaled(factor);
        }
        for law in &mut self.focus_laws {
            if let GroupTravel::Table(table) = &mut law.travel {
                *table = table.scaled(factor);
            }
        }
        self.focused_mm *= factor;
        self.image_breaks.iter_mut().for_each(|axis| *axis = axis.scaled(factor));
        self.arrange();
        Ok(self)
    }
}

fn scale_element(element: &mut Element, number: usize, factor: f64) -> Result<(), ScaleError> {
    let unknown = || ScaleError::Surface(number, element.kind.clone());
    element.surface = element.surface.scaled(factor).ok_or_else(unknown)?;
    // The parameters in the file no longer describe this surface.
    element.parameters = None;
    element.solid = element.solid.as_deref().map(|solid| Arc::new(Solid::scaled(solid, factor)));
    element.breaks.iter_mut().for_each(|axis| *axis = axis.scaled(factor));
    element.displacement = element.displacement.scaled(factor);
    element.thickness_mm *= factor;
    element.chamfer_mm *= factor;
    for size in [&mut element.semi_diameter_mm, &mut element.outer_semi_diameter_mm].into_iter().flatten() {
        *size *= factor;
    }
    let places = element.layers.iter_mut().map(|layer| &mut layer.places);
    let mut all: Vec<&mut Vec<Aperture>> = places.chain([&mut element.apertures]).collect();
    if let Some(separation) = &mut element.separation {
        separation.depth_mm = separation.depth_mm.map(|mm| mm * factor);
        all.push(&mut separation.places);
    }
    for aperture in all.into_iter().flatten() {
        *aperture = aperture.scaled(factor).ok_or(ScaleError::Drawing(number))?;
    }
    Ok(())
}

impl Aperture {
    /// Returns the aperture with all lengths multiplied by `factor`; `None` for a drawing.
    fn scaled(&self, factor: f64) -> Option<Self> {
        let by = |mm: &f64| mm * factor;
        let shape = match &self.shape {
            ApertureShape::Ring { inner_mm, outer_mm } => {
                ApertureShape::Ring { inner_mm: by(inner_mm), outer_mm: by(outer_mm) }
            }
            ApertureShape::Rectangle { half_width_mm, half_height_mm } => {
                ApertureShape::Rectangle { half_width_mm: by(half_width_mm), half_height_mm: by(half_height_mm) }
            }
            ApertureShape::Ellipse { half_width_mm, half_height_mm } => {
                ApertureShape::Ellipse { half_width_mm: by(half_width_mm), half_height_mm: by(half_height_mm) }
            }
            ApertureShape::Polygon(corners) => {
                ApertureShape::Polygon(corners.iter().map(|corner| corner.each_ref().map(by)).collect())
            }
            ApertureShape::Iris(iris) => {
                let mut iris = *iris;
                iris.blade_radius_mm *= factor;
                ApertureShape::Iris(iris)
            }
            ApertureShape::Mask(mask) => ApertureShape::Mask(mask.scaled(factor)),
            ApertureShape::Drawing(_) => return None,
        };
        Some(Self { shape, center_mm: self.center_mm.each_ref().map(by), obscures: self.obscures })
    }
}

impl Displacement {
    fn scaled(self, factor: f64) -> Self {
        Self { decenter_mm: self.decenter_mm.map(|mm| mm * factor), ..self }
    }
}

impl AxisBreak {
    fn scaled(self, factor: f64) -> Self {
        Self { displacement: self.displacement.scaled(factor), thickness_mm: self.thickness_mm * factor }
    }
}
