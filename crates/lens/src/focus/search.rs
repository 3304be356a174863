//! Focus by real rays: the smallest spot, or the highest contrast.
//!
//! They differ on fast lenses: the smallest root-mean-square spot weighs the wide halo of the marginal rays, contrast
//! the core of the spot. Both look through the plates before the frame, if there are any.

use super::FocusError;
use super::rings::Rings;
use crate::Lens;
use crate::beam::{Beam, ObjectPoint};
use crate::first_order::Section;

/// What the best focus is best at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Criterion {
    /// Least RMS distance of the rays from their centroid.
    Rms,
    /// Highest geometrical contrast at this spatial frequency, the mean of lines along x and along y.
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

/// Rays across the beam, of one wavelength; of many as many rays in all.
const CELLS: usize = 96;
/// Fewest rays across the beam.
const FEWEST_CELLS: usize = 32;
/// The best focus is as near to the image plane as that, mm, where groups were moved to it.
const FOUND_MM: f64 = 2e-5;
/// Steps toward it; each is a secant, so that a few do.
const STEPS: usize = 12;
/// Sections of a lens whose focal lengths differ by less than this part are alike.
const ALIKE: f64 = 1e-6;

/// The rays of a search.
enum Rays {
    /// Of a lens that is round, for a point on its axis.
    Rings(Rings),
    Beam(Beam),
}

impl FocusSearch {
    fn none(&self) -> FocusError {
        FocusError::NoLight { object_mm: self.object_mm, field_deg: self.field_rad.to_degrees() }
    }

    fn rays(&self, lens: &Lens) -> Result<Rays, FocusError> {
        if self.field_rad == 0.0
            && let Some(rings) = Rings::of(lens, self.object_mm, &self.light)?
        {
            return Ok(Rays::Rings(rings));
        }
        Ok(Rays::Beam(self.beam(lens)?))
    }

    fn beam(&self, lens: &Lens) -> Result<Beam, FocusError> {
        let point = ObjectPoint::on_plane(lens, self.object_mm, self.field_rad);
        let cells = (CELLS as f64 / (self.light.len().max(1) as f64).sqrt()) as usize;
        Beam::of(lens, point, &self.light, cells.max(FEWEST_CELLS))?.ok_or_else(|| self.none())
    }
}

impl Lens {
    /// How far behind its image plane, as it stands, this lens is at its best, mm along the image plane's z; nothing is
    /// moved.
    ///
    /// # Errors
    /// [`FocusError::NoLight`], [`FocusError::Medium`].
    pub fn best_focus_shift_mm(&self, search: &FocusSearch) -> Result<f64, FocusError> {
        let z = match (search.rays(self)?, search.criterion) {
            (Rays::Rings(rings), Criterion::Rms) => rings.least_rms_z_mm(),
            (Rays::Rings(rings), Criterion::Contrast { per_mm }) => rings.best_contrast_z_mm(per_mm),
            (Rays::Beam(beam), Criterion::Rms) => beam.least_rms_z_mm(),
            (Rays::Beam(beam), Criterion::Contrast { per_mm }) => beam.best_contrast_z_mm(per_mm),
        };
        z.ok_or_else(|| search.none())
    }

    /// How far the plane in which lines along x are sharpest lies behind that of lines along y, mm, for a lens with
    /// cylinders: `None` where one plane holds at least half of the contrast of both, or the search is not for contrast.
    ///
    /// # Errors
    /// [`FocusError::NoLight`], [`FocusError::Medium`].
    pub fn sections_apart_mm(&self, search: &FocusSearch) -> Result<Option<f64>, FocusError> {
        let Criterion::Contrast { per_mm } = search.criterion else { return Ok(None) };
        let [x, y] = [Section::X, Section::Y].map(|s| self.first_order_in(s, self.reference_nm).efl_mm);
        if (x - y).abs() <= ALIKE * y.abs() {
            return Ok(None);
        }
        Ok(search.beam(self)?.sections_z_mm(per_mm).map(|[x, y]| y - x))
    }

    /// The same lens, which is focused there by paraxial optics already (see [`Lens::focused_at`]), moved on to where the
    /// search finds it best: its groups where they share a travel, otherwise the whole lens.
    ///
    /// # Errors
    /// [`FocusError`].
    pub fn focused_by(self, search: &FocusSearch) -> Result<Self, FocusError> {
        let shift = self.best_focus_shift_mm(search)?;
        let mut lens = if self.has_factors() {
            self.moved_to_best(search, shift)?
        } else {
            // Rays come from the object as before, so that the search need not be done again.
            let gap_mm = self.image_gap_mm() + self.sense_behind() * shift;
            self.with_image_gap_mm(gap_mm)
        };
        lens.focused_mm = search.object_mm;
        Ok(lens)
    }

    /// Moves groups on until the best focus, now `shift` behind the image plane, lies in it.
    fn moved_to_best(&self, search: &FocusSearch, shift: f64) -> Result<Self, FocusError> {
        let gap = |lens: &Self| lens.paraxial_defocus_mm(search.object_mm);
        let probe_mm = 1e-3;
        // How far the image comes in front of the image plane as the groups travel on.
        let rate = (gap(self) - gap(&self.moved_on(probe_mm)?)) / probe_mm * self.sense_behind();
        let (mut before, mut here) = ((0.0, shift), (shift / rate, shift));
        for _ in 0..STEPS {
            let lens = self.moved_on(here.0)?;
            here.1 = lens.best_focus_shift_mm(search)?;
            if here.1.abs() < FOUND_MM {
                return Ok(lens);
            }
            let next = here.0 - here.1 * (here.0 - before.0) / (here.1 - before.1);
            if !next.is_finite() {
                break;
            }
            (before, here) = (here, (next, here.1));
        }
        Err(FocusError::NoTravel { object_mm: search.object_mm })
    }
}
