//! Focus by real rays: the smallest spot, or the highest contrast.
//!
//! They differ on fast lenses: the smallest root-mean-square spot weighs the wide halo of the marginal rays, contrast
//! the core of the spot.

use super::FocusError;
use crate::Lens;
use crate::beam::{Beam, ObjectPoint, golden_section};

/// What the best focus is best at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Criterion {
    /// Least RMS distance of the rays from their centroid.
    Rms,
    /// Highest geometrical contrast at this spatial frequency, line pairs a mm.
    Contrast {
        /// Line pairs a mm on the image plane.
        per_mm: f64,
    },
}

/// What to focus on, and by what.
#[derive(Clone, Debug, PartialEq)]
pub struct FocusSearch {
    /// Distance of the object plane from the first vertex, mm; infinity allowed.
    pub object_mm: f64,
    /// Field angle of the object point, rad.
    pub field_rad: f64,
    /// Measure.
    pub criterion: Criterion,
    /// Wavelengths, nm, with their weights.
    pub light: Vec<(f64, f64)>,
}

/// Rays across the beam.
const CELLS: usize = 96;

impl FocusSearch {
    fn beam(&self, lens: &Lens) -> Result<Beam, FocusError> {
        let point = ObjectPoint::on_plane(lens, self.object_mm, self.field_rad);
        let none = FocusError::NoLight { object_mm: self.object_mm, field_deg: self.field_rad.to_degrees() };
        Beam::of(lens, point, &self.light, CELLS)?.ok_or(none)
    }

    /// What is to be small, on the plane `z_mm` behind the image plane.
    fn badness(&self, beam: &Beam, z_mm: f64) -> f64 {
        match self.criterion {
            Criterion::Rms => beam.rms_mm(z_mm),
            Criterion::Contrast { per_mm } => -beam.contrast(z_mm, per_mm),
        }
    }
}

impl Lens {
    /// How far behind its image plane, as it stands, this lens is at its best, mm along the image plane's z; nothing is
    /// moved.
    ///
    /// # Errors
    /// [`FocusError::NoLight`], [`FocusError::Medium`].
    pub fn best_focus_shift_mm(&self, search: &FocusSearch) -> Result<f64, FocusError> {
        let beam = search.beam(self)?;
        let z = match search.criterion {
            Criterion::Rms => beam.least_rms_z_mm(),
            Criterion::Contrast { per_mm } => beam.best_contrast_z_mm(per_mm),
        };
        let none = FocusError::NoLight { object_mm: search.object_mm, field_deg: search.field_rad.to_degrees() };
        z.ok_or(none)
    }

    /// The same lens, which is focused there by paraxial optics already (see [`Lens::focused_at`]), moved on to where the
    /// search finds it best: its groups where they share a travel, otherwise the whole lens.
    ///
    /// # Errors
    /// [`FocusError`].
    pub fn focused_by(self, search: &FocusSearch) -> Result<Self, FocusError> {
        let shift = self.best_focus_shift_mm(search)?;
        let mut lens = if self.has_factors() {
            let gap =
                |lens: &Self| lens.paraxial_image_gap_mm(search.object_mm, lens.reference_nm) - lens.image_gap_mm();
            let probe_mm = 1e-3;
            // How far the image comes in front of the image plane as the groups travel on.
            let rate = (gap(&self) - gap(&self.moved_on(probe_mm)?)) / probe_mm;
            let middle = shift / rate;
            let half = 0.5 * middle.abs() + (0.01 / rate).abs();
            let badness = |travel_mm: f64| {
                let moved = self.moved_on(travel_mm).ok();
                let beam = moved.and_then(|lens| search.beam(&lens).ok());
                beam.map_or(f64::INFINITY, |beam| search.badness(&beam, 0.0))
            };
            self.moved_on(golden_section(middle - half, middle + half, badness))?
        } else {
            let gap_mm = self.image_gap_mm() + shift;
            self.with_image_gap_mm(gap_mm)
        };
        lens.focused_mm = search.object_mm;
        Ok(lens)
    }
}
