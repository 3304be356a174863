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

use crate::cells::{BOTH_WAYS, Cells, with_margin};
use crate::known::Known;
use crate::raster::Raster;
use crate::scatter::PointSpread;
use spectra_numerics::convolve::Convolver;
use std::f64::consts::PI;
use std::sync::Arc;

/// Kernels on a plane, by their length in mm: how many pixels wide the cells are that they are made for, and they.
static CONVOLVERS: Known<(f64, Raster), (usize, Convolver<f32>)> = Known::new();

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

/// Cells are as wide as the length of diffusion holds so many of them, at least: what they lose of the finest patterns has
/// diffused to a tenth, and is within 0.01 of the gain.
const CELLS_A_LENGTH: f64 = 2.0;

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
    convolver: Arc<(usize, Convolver<f32>)>,
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
            let mut cell_px = 1;
            while adjacency.length_mm >= 2.0 * CELLS_A_LENGTH * raster.pitch_mm * cell_px as f64 {
                cell_px *= 2;
            }
            let spread = PointSpread::bessel(adjacency.length_mm);
            let kernel = spread.over_pixels(raster.pitch_mm * cell_px as f64, BEYOND, LONGEST);
            let kernel = kernel.cropped(raster.width.max(raster.height));
            if cell_px == 1 {
                return (1, Convolver::new(&kernel, raster.width, raster.height));
            }
            // A cell is wider than a pixel, whose twelfth the kernel has, too.
            let wide = cell_px as f64;
            let kernel = kernel.sharpened(BOTH_WAYS + (1.0 - 1.0 / (wide * wide)) / 24.0);
            let [width, height] = [raster.width, raster.height].map(|pixels| with_margin(pixels, cell_px));
            (cell_px, Convolver::new(&kernel, width, height))
        });
        Self { raster: *raster, gain: adjacency.gain, convolver }
    }

    /// Applies the effect to a plane of amounts (density of silver, or dye), in place. Beside the frame lies film with
    /// the amount `unexposed`; amounts stay within `range`, the ends of the curve. Takes memory for one more plane, or half of one
    /// where pixels are fine.
    ///
    /// # Panics
    /// If the plane has another number of pixels than the raster.
    pub fn apply(&self, amounts: &mut [f32], unexposed: f64, range: (f64, f64)) {
        assert_eq!(amounts.len(), self.raster.pixels(), "the plane has the size that was prepared for");
        let (gain, (low, high)) = (self.gain, range);
        let develop = |to: &mut f32, diffused: f64| {
            let here = f64::from(*to);
            let change = gain * (here - unexposed - diffused);
            let room = if change < 0.0 { here - low } else { high - here };
            if room > 0.0 && change != 0.0 {
                *to = (here + change / (1.0 + change.abs() / room)) as f32;
            }
        };
        let (cell_px, convolver) = &*self.convolver;
        let over = |amount: f32| amount - unexposed as f32;
        if *cell_px == 1 {
            let over: Vec<f32> = amounts.iter().map(|a| over(*a)).collect();
            convolver.apply(&over, amounts, |to, v| develop(to, f64::from(v)));
        } else {
            let size = [self.raster.width, self.raster.height];
            let mut cells = Cells::of_pixels(amounts, size, *cell_px, over);
            cells.convolve(convolver);
            cells.over_pixels(amounts, self.raster.width, |to, v| develop(to, f64::from(v)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On cells an edge, a dot and fine texture are developed as on the pixels themselves, wherever they lie on the cells.
    #[test]
    fn cells_do_what_pixels_do() {
        let (width, height, pitch_mm) = (301, 203, 0.004);
        let adjacency = Adjacency { gain: 0.25, length_mm: 0.037 };
        let raster = Raster::new(width, height, pitch_mm);
        let edges = Edges::new(&adjacency, &raster);
        assert_eq!(edges.convolver.0, 4);
        let amount = |x: usize, y: usize| match (x, y) {
            (150 | 151, 90) => 2.0,
            (70..=103, _) => 1.1,
            (_, 130..) => 0.3 + 0.2 * ((x * 7919 + y * 104_729) % 101) as f32 / 100.0,
            _ => 0.4,
        };
        let plane: Vec<f32> = (0..width * height).map(|k| amount(k % width, k / width)).collect();
        let mut got = plane.clone();
        edges.apply(&mut got, 0.1, (0.0, 3.0));
        let kernel = PointSpread::bessel(adjacency.length_mm).over_pixels(pitch_mm, BEYOND, LONGEST);
        let on_pixels = Edges { convolver: Arc::new((1, Convolver::new(&kernel, width, height))), ..edges };
        let mut want = plane.clone();
        on_pixels.apply(&mut want, 0.1, (0.0, 3.0));
        let most = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        println!("change {}, off by {}", most(&plane, &want), most(&got, &want));
        assert!(most(&plane, &want) > 0.05 && most(&got, &want) < 0.003);
    }
}
