//! A lens as a figure: glass, stop, image plane, and rays in the colors of their wavelengths.

mod outline;
mod rays;
mod sheet;

pub use outline::{Outlines, Solid, outlines};
pub use rays::Fans;
pub use sheet::{Ground, Sheet};

use glam::DVec3;
use spectra_core::Loss;
use spectra_lens::{Lens, RayPath, Section};

/// A ray to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnRay {
    /// Its way.
    pub path: RayPath,
    /// Its wavelength, nm.
    pub wavelength_nm: f64,
    /// Brightness on a dark ground, relative to the brightest: 0 to 1.
    pub strength: f64,
}

impl DrawnRay {
    /// Whether it goes on behind its last point: it left the lens, or met no further surface.
    #[must_use]
    pub fn goes_on(&self) -> bool {
        matches!(self.path.end, None | Some((Loss::Missed, _)))
    }
}

/// The plane that a lens is cut in: z runs to the right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct View {
    /// y or x upward.
    pub section: Section,
}

impl View {
    /// A point across the axis, in the frame of a surface.
    #[must_use]
    pub fn across(&self, height_mm: f64, z_mm: f64) -> DVec3 {
        match self.section {
            Section::X => DVec3::new(height_mm, 0.0, z_mm),
            Section::Y => DVec3::new(0.0, height_mm, z_mm),
        }
    }

    /// Height of a point in the figure, mm.
    #[must_use]
    pub fn vertical(&self, point: DVec3) -> f64 {
        match self.section {
            Section::X => point.x,
            Section::Y => point.y,
        }
    }

    /// Place of a point in the figure, mm: right and up.
    #[must_use]
    pub fn place(&self, point: DVec3) -> [f64; 2] {
        [point.z, self.vertical(point)]
    }
}

/// How far from its vertex light meets each element, mm.
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
