//! Scatter of light inside of the emulsion: what a film's modulation transfer function says.
//!
//! Turbid gelatin spreads the light of each point over some micrometers; a sine target of the frequency f keeps the part
//! M(f) of its contrast. The spread is the same in all directions, and negative nowhere: see [`Scatter::new`] for how
//! exactly it then follows the curve.

mod fit;
mod mtf;

pub use mtf::{Mtf, MtfError};

use crate::convolve::Convolver;
use crate::raster::Raster;

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
    convolver: Convolver,
    residual: f64,
}

impl Scatter {
    /// Prepares scatter by `mtf` for planes of the size and pitch of `raster`.
    ///
    /// The kernel is the one of weights from 0 on that comes closest to the curve below 0.8 of the pixels' limit
    /// (half a cycle a pixel), by projections onto both demands in turn; [`Scatter::residual`] says how close. Pixels of
    /// 6 um and less follow the curve of a usual film within 0.01. On larger ones most light stays in its pixel, and weights
    /// from 0 on cannot follow to the limit.
    ///
    /// # Errors
    /// [`MtfError::OutOfRange`] for a pitch that is not positive and finite, or so fine (under a thousandth of the
    /// spread) that the kernel would not fit into memory.
    pub fn new(mtf: &Mtf, raster: &Raster) -> Result<Self, MtfError> {
        let fit = fit::fit(mtf, raster.pitch_mm)?;
        let convolver = Convolver::new(&fit.kernel, raster.width, raster.height);
        Ok(Self { raster: *raster, convolver, residual: fit.residual })
    }

    /// Largest difference between the kernel's response and the curve, below 0.8 of the pixels' limit.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.residual
    }

    /// Scatters the light of a plane of exposure (linear; any unit), in place.
    ///
    /// The kernel sums to 1: the plane's sum stays but for what falls beside it. The plane is a whole frame; around it
    /// the film is unexposed. Values that are no number count as 0. Takes memory for one more plane.
    ///
    /// # Panics
    /// If the plane has another number of pixels than the raster.
    pub fn apply(&self, exposure: &mut [f32]) {
        assert_eq!(exposure.len(), self.raster.pixels(), "the plane has the size that was prepared for");
        let source = exposure.to_vec();
        self.convolver.apply(&source, exposure, |to, v| *to = v.max(0.0) as f32);
    }
}
