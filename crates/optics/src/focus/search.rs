//! Searches for the best focus by real rays: for the smallest spot or the highest contrast.
//!
//! The two differ on fast lenses: the smallest root-mean-square spot depends on the wide halo of the marginal rays, contrast
//! on the core of the spot. Both include the plates in front of the frame, if there are any.

use super::rings::Rings;
use crate::Optics;
use crate::beam::Beam;
use crate::bundle::ObjectPoint;
use spectra_lens::FocusError;
use spectra_lens::Lens;
use spectra_lens::Section;

/// The quantity that the best focus optimizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Criterion {
    /// Smallest RMS distance of the rays from their centroid.
    Rms,
    /// Highest geometrical contrast at one spatial frequency, averaged over lines along x and along y.
    Contrast {
        /// Spatial frequency on the image plane, line pairs per mm.
        per_mm: f64,
    },
}

/// The object, the criterion and the light of a search for the best focus.
#[derive(Clone, Debug, PartialEq)]
pub struct FocusSearch {
    /// Distance of the object plane from the first vertex, mm; infinity allowed.
    pub object_mm: f64,
    /// Field angle of the object point, rad.
    pub field_rad: f64,
    /// Criterion of the best focus.
    pub criterion: Criterion,
    /// Wavelengths of the light (nm) with their weights.
    pub light: Vec<(f64, f64)>,
}

/// Rays across the beam for one wavelength. For several wavelengths the total number of rays stays the same.
const CELLS: usize = 96;
/// Smallest number of rays across the beam.
const FEWEST_CELLS: usize = 32;
/// Distance (mm) of the best focus from the image plane below which the search with moving groups stops.
const FOUND_MM: f64 = 2e-5;
/// Largest number of steps of that search; each is a secant step, so a few suffice.
const STEPS: usize = 12;
/// Relative difference of focal lengths below which the two sections of a lens count as equal.
const ALIKE: f64 = 1e-6;

/// The rays of a focus search.
enum Rays {
    /// Rings of a round lens, for a point on its axis.
    Rings(Rings),
    Beam(Beam),
}

impl FocusSearch {
    fn none(&self) -> FocusError {
        FocusError::NoLight { object_mm: self.object_mm, field_deg: self.field_rad.to_degrees() }
    }

    fn rays(&self, optics: &Optics) -> Result<Rays, FocusError> {
        if self.field_rad == 0.0
            && let Some(rings) = Rings::trace(optics, self.object_mm, &self.light)?
        {
            return Ok(Rays::Rings(rings));
        }
        Ok(Rays::Beam(self.beam(optics)?))
    }

    fn beam(&self, optics: &Optics) -> Result<Beam, FocusError> {
        let point = ObjectPoint::on_plane(optics, self.object_mm, self.field_rad);
        let cells = (CELLS as f64 / (self.light.len().max(1) as f64).sqrt()) as usize;
        Beam::trace(optics, point, &self.light, cells.max(FEWEST_CELLS))?.ok_or_else(|| self.none())
    }

    /// Returns how far the best focus lies behind the present image plane of a lens, mm along the plane's z. The lens itself
    /// stays as it is.
    ///
    /// # Errors
    /// [`FocusError::NoLight`], [`FocusError::Medium`].
    pub fn shift_mm(&self, optics: &Optics) -> Result<f64, FocusError> {
        let z = match (self.rays(optics)?, self.criterion) {
            (Rays::Rings(rings), Criterion::Rms) => rings.least_rms_z_mm(),
            (Rays::Rings(rings), Criterion::Contrast { per_mm }) => rings.best_contrast_z_mm(per_mm),
            (Rays::Beam(beam), Criterion::Rms) => beam.least_rms_z_mm(),
            (Rays::Beam(beam), Criterion::Contrast { per_mm }) => beam.best_contrast_z_mm(per_mm),
        };
        z.ok_or_else(|| self.none())
    }

    /// Returns, for a lens with cylinders, how far (mm) the plane in which lines along x are sharpest lies behind that for lines
    /// along y. Returns `None` if either plane keeps at least half of the contrast of the other, or the criterion is not
    /// contrast.
    ///
    /// # Errors
    /// [`FocusError::NoLight`], [`FocusError::Medium`].
    pub fn sections_apart_mm(&self, optics: &Optics) -> Result<Option<f64>, FocusError> {
        let Criterion::Contrast { per_mm } = self.criterion else { return Ok(None) };
        let [x, y] = [Section::X, Section::Y].map(|s| optics.first_order_in(s, optics.reference_nm).efl_mm);
        if (x - y).abs() <= ALIKE * y.abs() {
            return Ok(None);
        }
        Ok(self.beam(optics)?.sections_z_mm(per_mm).map(|[x, y]| y - x))
    }

    /// Moves a lens that is already focused by paraxial optics (see [`Lens::focused_at`]) to its best focus. It moves the lens's
    /// groups if they share a travel, otherwise the whole lens.
    ///
    /// # Errors
    /// [`FocusError`].
    pub fn focus(&self, lens: Lens) -> Result<Lens, FocusError> {
        let optics = Optics::new(lens);
        let shift = self.shift_mm(&optics)?;
        let mut lens = if optics.has_factors() {
            self.move_groups(&optics, shift)?
        } else {
            // Rays come from the object as before, so the search need not be repeated.
            let gap_mm = optics.image_gap_mm() + optics.sense_behind() * shift;
            Lens::clone(&optics).with_image_gap_mm(gap_mm)
        };
        lens.focused_mm = self.object_mm;
        Ok(lens)
    }

    /// Moves the groups of a lens until the best focus, now `shift` behind the image plane, lies in it.
    fn move_groups(&self, lens: &Lens, shift: f64) -> Result<Lens, FocusError> {
        let gap = |lens: &Lens| lens.paraxial_defocus_mm(self.object_mm);
        let probe_mm = 1e-3;
        // Distance that the image moves forward from the image plane per mm of travel of the groups.
        let rate = (gap(lens) - gap(&lens.moved_on(probe_mm)?)) / probe_mm * lens.sense_behind();
        let (mut before, mut here) = ((0.0, shift), (shift / rate, shift));
        for _ in 0..STEPS {
            let optics = Optics::new(lens.moved_on(here.0)?);
            here.1 = self.shift_mm(&optics)?;
            if here.1.abs() < FOUND_MM {
                return Ok(Lens::clone(&optics));
            }
            let next = here.0 - here.1 * (here.0 - before.0) / (here.1 - before.1);
            if !next.is_finite() {
                break;
            }
            (before, here) = (here, (next, here.1));
        }
        Err(FocusError::NoTravel { object_mm: self.object_mm })
    }
}
