//! Drawings of a lens: glass, stop, image plane, and rays in the colors of their wavelengths.

mod outline;
mod rays;
mod sheet;

pub use outline::{Outlines, Solid, outlines};
pub use rays::Fans;
pub use sheet::{DrawingBackground, Sheet};

use glam::DVec3;
use spectra_core::Loss;
use spectra_lens::{Lens, Section};
use spectra_tracer::RayPath;

/// A ray to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnRay {
    /// Path of the ray through the lens.
    pub path: RayPath,
    /// Wavelength, nm.
    pub wavelength_nm: f64,
    /// Brightness on a dark ground, relative to the brightest: 0 to 1.
    pub strength: f64,
}

impl DrawnRay {
    /// Whether the drawing continues the ray straight beyond its last point: the ray left the lens, or met no further surface.
    #[must_use]
    pub fn goes_on(&self) -> bool {
        matches!(self.path.end, None | Some((Loss::Missed, _)))
    }
}

/// The section plane of a drawing, in which z runs to the right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SectionView {
    /// The section shown: y (or x) points upward.
    pub section: Section,
}

impl SectionView {
    /// Returns the point of the section at the height `height_mm` and the position `z_mm` along the axis, in the frame of a
    /// surface.
    #[must_use]
    pub fn across(&self, height_mm: f64, z_mm: f64) -> DVec3 {
        match self.section {
            Section::X => DVec3::new(height_mm, 0.0, z_mm),
            Section::Y => DVec3::new(0.0, height_mm, z_mm),
        }
    }

    /// Returns the height of a point above the axis as the figure shows it, mm.
    #[must_use]
    pub fn vertical(&self, point: DVec3) -> f64 {
        match self.section {
            Section::X => point.x,
            Section::Y => point.y,
        }
    }

    /// Returns the position of a point in the figure, mm: to the right (z) and up.
    #[must_use]
    pub fn place(&self, point: DVec3) -> [f64; 2] {
        [point.z, self.vertical(point)]
    }
}

/// Returns for each element of the lens how far from its vertex, measured across its axis, the outermost of `rays` meets it, mm.
#[must_use]
pub fn reach_mm(lens: &Lens, rays: &[DrawnRay]) -> Vec<f64> {
    let mut reach = vec![0.0_f64; lens.elements.len()];
    for ray in rays {
        for (at, point) in ray.path.elements.iter().zip(ray.path.points.iter().skip(1)) {
            let local = lens.elements[*at].pose.local_point(*point);
            reach[*at] = reach[*at].max(local.truncate().length());
        }
    }
    reach
}
