//! Scatter of light inside of the emulsion: what a film's modulation transfer function says.
//!
//! Turbid gelatin spreads the light of each point over some micrometers; a sine target of the frequency f keeps the part
//! M(f) of its contrast. The spread is one function of the distance from the point, a sum of Gaussians: round, falling
//! and positive whatever the curve, and the same for pixels of any size, which get its integral over each of them.
//!
//! A sheet's curve is measured on the developed film, and exceeds 1 where development makes edges stand out. That is not
//! the light's doing: [`Modulation`] takes the curve apart into the light's spread and [`crate::adjacency`].

mod modulation;
mod mtf;
mod spread;
mod spreading;

pub use modulation::Modulation;
pub use mtf::{Mtf, MtfError};
pub use spread::PointSpread;
pub(crate) use spreading::Spreading;

use crate::known::Known;
use crate::raster::Raster;
use std::sync::Arc;

/// Kernels on a plane.
static KERNELS: Known<(Mtf, Raster), Spreading> = Known::new();

/// Part of the light that may be beyond the kernel.
const BEYOND: f64 = 1e-9;

/// Pixels that a kernel reaches at most.
const LONGEST: usize = 2000;

/// The scatter of one layer on planes of one size.
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
    spreading: Arc<Spreading>,
}

impl Scatter {
    /// Prepares scatter by `mtf` for planes of the size and pitch of `raster`.
    ///
    /// The light of a pixel spreads from its middle, and each pixel gets the integral of the spread over it. So a sine
    /// keeps M(f), and the pixels' own loss, sin(pi f p) / (pi f p), once more.
    ///
    /// # Errors
    /// [`MtfError::OutOfRange`] for a pitch that is not positive and finite, or so fine that the spread is over
    /// 2000 pixels wide.
    pub fn new(mtf: &Mtf, raster: &Raster) -> Result<Self, MtfError> {
        let pitch_mm = raster.pitch_mm;
        let out_of_range = |range| MtfError::OutOfRange { what: "pitch", value: pitch_mm, range };
        if !(pitch_mm > 0.0 && pitch_mm.is_finite()) {
            return Err(out_of_range("more than 0 mm"));
        }
        if mtf.spread().reach_mm(BEYOND) / pitch_mm > LONGEST as f64 {
            return Err(out_of_range("at least a 2000th of the spread"));
        }
        let made = || Spreading::new(mtf.spread(), raster, BEYOND, LONGEST);
        Ok(Self { raster: *raster, spreading: KERNELS.of((mtf.clone(), *raster), made) })
    }

    /// Scatters the light of a plane of exposure (linear; any unit), in place.
    ///
    /// The kernel sums to 1: the plane's sum stays but for what falls beside it. The plane is a whole frame; around it
    /// the film is unexposed. Values that are no number count as 0. Takes memory for one more plane.
    ///
    /// # Panics
    /// If the plane has another number of pixels than the raster.
    pub fn apply(&self, exposure: &mut [f32]) {
        exposure.copy_from_slice(&self.applied(exposure));
    }

    /// The plane that [`Scatter::apply`] makes of `exposure`.
    ///
    /// # Panics
    /// If the plane has another number of pixels than the raster.
    #[must_use]
    pub fn applied(&self, exposure: &[f32]) -> Vec<f32> {
        let mut spread = vec![0.0; exposure.len()];
        self.apply_to(exposure, &mut spread);
        spread
    }

    /// Writes the plane that [`Scatter::apply`] makes of `exposure`.
    ///
    /// # Panics
    /// If a plane has another number of pixels than the raster.
    pub fn apply_to(&self, exposure: &[f32], to: &mut [f32]) {
        assert_eq!(exposure.len(), self.raster.pixels(), "the plane has the size that was prepared for");
        self.spreading.apply(exposure, to, |to, v| *to = v.max(0.0) as f32);
    }
}
