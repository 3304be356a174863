//! Scatter of light inside the emulsion, described by the modulation transfer function of a film.
//!
//! Turbid gelatin spreads the light of each point over some micrometers; a sine target of the frequency f keeps the fraction M(f)
//! of its contrast. The spread is a function of the distance from the point, a sum of Gaussians. For any curve it is round,
//! positive, decreasing with the distance and independent of the pixel size. A pixel gets its integral over the pixel.
//!
//! A sheet's curve is measured on the developed film, and exceeds 1 where development enhances edges. Light does not cause that:
//! [`Modulation`] separates the curve into the spread of light and [`crate::adjacency`].

mod modulation;
mod mtf;
mod prepared_spread;
mod spread;

pub use modulation::Modulation;
pub use mtf::{Mtf, MtfError};
pub(crate) use prepared_spread::PreparedSpread;
pub use spread::PointSpread;

use crate::cache::Cache;
use crate::raster::Raster;
use std::sync::Arc;

/// Cache of kernels on a plane.
static KERNELS: Cache<(Mtf, Raster), PreparedSpread> = Cache::new();

/// Fraction of the light that may lie outside the kernel.
const BEYOND: f64 = 1e-9;

/// Largest radius of a kernel, pixels.
const LONGEST: usize = 2000;

/// Light scatter in one emulsion layer, prepared for exposure planes of one size and pixel pitch.
///
/// ```
/// use spectra_film::raster::Raster;
/// use spectra_film::scatter::{Mtf, Scatter};
/// let mtf = Mtf::frieser(0.015)?; // half of the contrast is left at 49 cycles/mm
/// let raster = Raster::new(90, 60, 0.004);
/// let mut exposure = vec![0.0; raster.pixels()];
/// exposure[30 * 90 + 45] = 1000.0;
/// Scatter::new(&mtf, &raster)?.apply(&mut exposure);
/// let sum: f64 = exposure.iter().map(|v| f64::from(*v)).sum();
/// assert!((sum - 1000.0).abs() < 1e-3);
/// # Ok::<(), spectra_film::scatter::MtfError>(())
/// ```
pub struct Scatter {
    raster: Raster,
    spreading: Arc<PreparedSpread>,
}

impl Scatter {
    /// Prepares scatter by `mtf` for planes of the size and pitch of `raster`.
    ///
    /// The light of a pixel spreads from its center, and each pixel gets the integral of the spread over its area. So a sine keeps M(f),
    /// times the loss of the pixels themselves, sin(pi f p) / (pi f p).
    ///
    /// # Errors
    /// [`MtfError::OutOfRange`] for a pitch that is not positive and finite, or so fine that the spread reaches more than 2000 pixels.
    pub fn new(mtf: &Mtf, raster: &Raster) -> Result<Self, MtfError> {
        let pitch_mm = raster.pitch_mm;
        let out_of_range = |range| MtfError::OutOfRange { what: "pitch", value: pitch_mm, range };
        if !(pitch_mm > 0.0 && pitch_mm.is_finite()) {
            return Err(out_of_range("more than 0 mm"));
        }
        if mtf.spread().reach_mm(BEYOND) / pitch_mm > LONGEST as f64 {
            return Err(out_of_range("at least a 2000th of the spread"));
        }
        let made = || PreparedSpread::new(mtf.spread(), raster, BEYOND, LONGEST);
        Ok(Self { raster: *raster, spreading: KERNELS.get_or_compute((mtf.clone(), *raster), made) })
    }

    /// Scatters the light of a plane of exposure (linear; any unit), in place.
    ///
    /// The kernel sums to 1: the sum of the plane changes only by the light that falls outside. The plane is a whole frame; the film around
    /// it is unexposed. NaN counts as 0. Needs memory for one more plane.
    ///
    /// # Panics
    /// If the number of pixels of the plane differs from that of the raster.
    pub fn apply(&self, exposure: &mut [f32]) {
        exposure.copy_from_slice(&self.applied(exposure));
    }

    /// Returns the plane that [`Scatter::apply`] makes of `exposure`.
    ///
    /// # Panics
    /// If the number of pixels of the plane differs from that of the raster.
    #[must_use]
    pub fn applied(&self, exposure: &[f32]) -> Vec<f32> {
        let mut spread = vec![0.0; exposure.len()];
        self.apply_to(exposure, &mut spread);
        spread
    }

    /// Writes the plane that [`Scatter::apply`] makes of `exposure` to `to`.
    ///
    /// # Panics
    /// If the number of pixels of a plane differs from that of the raster.
    pub fn apply_to(&self, exposure: &[f32], to: &mut [f32]) {
        assert_eq!(exposure.len(), self.raster.pixels(), "the plane has the size that was prepared for");
        self.spreading.apply(exposure, to, |to, v| *to = v.max(0.0) as f32);
    }
}
