//! Adjacency: edges that development makes stand out.
//!
//! Where much silver is developed the developer tires and gives off bromide; both diffuse. So beside a dense place less is
//! developed than there would be, at a dense place's border more: a line of overshoot on either side of an edge (E. Mackie's
//! lines; C. E. K. Mees and T. H. James, "The Theory of the Photographic Process", 3rd edition, 1966, on adjacency effects), and a response to fine
//! patterns above 1. Large even areas keep the densities of the characteristic curve, which was measured on such.
//!
//! What has diffused from a point lies about it as K0(r / l), the solution of diffusion with loss in a layer; with the
//! amount D of silver or dye, the change is
//!
//! gain * (D - D * K0),
//!
//! and a sine of the frequency f is developed 1 + gain (1 - 1 / (1 + (2 pi l f)^2)) times as strong. There is no less than no silver
//! and no more than all of it: near either end of the curve the change d is held to d / (1 + |d| / room).

use crate::known::Known;
use crate::raster::Raster;
use crate::scatter::PointSpread;
use spectra_numerics::convolve::Convolver;
use std::f64::consts::PI;
use std::sync::Arc;

/// Kernels on a plane, by their length in mm.
static CONVOLVERS: Known<(f64, Raster), Convolver> = Known::new();

/// How strong and how wide the effect is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adjacency {
    /// Largest gain of the contrast of fine patterns, from 0 on.
    pub gain: f64,
    /// Length over which diffusion reaches, mm, above 0.
    pub length_mm: f64,
}

/// Part of what diffuses that may be beyond the kernel; and the most pixels that it reaches.
const BEYOND: f64 = 1e-4;
const LONGEST: usize = 1000;

impl Adjacency {
    /// What a sine of `frequency` cycles/mm is developed to, over what it would be without.
    #[must_use]
    pub fn response(&self, frequency: f64) -> f64 {
        let x = 2.0 * PI * self.length_mm * frequency;
        1.0 + self.gain * (1.0 - 1.0 / (1.0 + x * x))
    }
}

/// The effect on planes of one size.
///
/// ```
/// use spectra_film::adjacency::{Adjacency, Edges};
/// use spectra_film::raster::Raster;
/// let raster = Raster::new(200, 20, 0.01);
/// let mut density: Vec<f32> = (0..4000).map(|k| if k % 200 < 100 { 1.0 } else { 0.4 }).collect();
/// let edges = Edges::new(&Adjacency { gain: 0.2, length_mm: 0.04 }, &raster);
/// edges.apply(&mut density, 0.0, (0.0, 2.5));
/// let row = &density[10 * 200..11 * 200];
/// assert!(row[99] > 1.03 && row[100] < 0.37);
/// ```
pub struct Edges {
    raster: Raster,
    gain: f64,
    convolver: Arc<Convolver>,
}

impl Edges {
    /// Prepares the effect for planes of the size and pitch of `raster`.
    ///
    /// # Panics
    /// If the pitch or the length is not positive and finite.
    #[must_use]
    pub fn new(adjacency: &Adjacency, raster: &Raster) -> Self {
        let good = |v: f64| v > 0.0 && v.is_finite();
        assert!(good(raster.pitch_mm) && good(adjacency.length_mm), "a pitch and a length above 0");
        let convolver = CONVOLVERS.of((adjacency.length_mm, *raster), || {
            let spread = PointSpread::bessel(adjacency.length_mm);
            let kernel = spread.over_pixels(raster.pitch_mm, BEYOND, LONGEST);
            let kernel = kernel.cropped(raster.width.max(raster.height));
            Convolver::new(&kernel, raster.width, raster.height)
        });
        Self { raster: *raster, gain: adjacency.gain, convolver }
    }

    /// Applies the effect to a plane of amounts (density of silver, or dye), in place. Beside the frame lies film with
    /// the amount `unexposed`; amounts stay within `range`, the ends of the curve. Takes memory for one more plane.
    ///
    /// # Panics
    /// If the plane has another number of pixels than the raster.
    pub fn apply(&self, amounts: &mut [f32], unexposed: f64, range: (f64, f64)) {
        assert_eq!(amounts.len(), self.raster.pixels(), "the plane has the size that was prepared for");
        let over: Vec<f32> = amounts.iter().map(|a| a - unexposed as f32).collect();
        let (gain, (low, high)) = (self.gain, range);
        self.convolver.apply(&over, amounts, |to, diffused| {
            let here = f64::from(*to);
            let change = gain * (here - unexposed - diffused);
            let room = if change < 0.0 { here - low } else { high - here };
            if room > 0.0 && change != 0.0 {
                *to = (here + change / (1.0 + change.abs() / room)) as f32;
            }
        });
    }
}
