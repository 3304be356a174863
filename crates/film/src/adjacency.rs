//! Adjacency effects: development makes edges stand out.
//!
//! Where much silver develops, the developer is exhausted and releases bromide; both diffuse. So less develops next to a dense area, and
//! more at the border of the dense area.
//! This gives a line of overshoot on either side of an edge (E. Mackie's lines; C. E. K. Mees and T. H. James, "The Theory of the
//! Photographic Process", 3rd edition, 1966, on adjacency effects), and a response to fine patterns above 1.
//! Large even areas keep the densities of the characteristic curve, which was measured on such areas.
//!
//! The products that diffuse from a point are distributed as K0(r / l), the solution of diffusion with loss in a layer. With the amount D
//! of silver or dye, the change is
//!
//! gain * (D - D * K0),
//!
//! and a sine of the frequency f is developed 1 + gain (1 - 1 / (1 + (2 pi l f)^2)) times as strongly. There cannot be less than no silver
//! or more than all of it: near either end of the curve the change d is reduced to d / (1 + |d| / room).

use crate::cache::Cache;
use crate::cells::{BOTH_WAYS, Cells, with_margin};
use crate::raster::Raster;
use crate::scatter::PointSpread;
use spectra_numerics::convolve::{Convolver, Kernel};
use std::f64::consts::PI;
use std::sync::Arc;

/// Cache of diffusion kernels on a plane, by the diffusion length in mm.
static DIFFUSIONS: Cache<(f64, Raster), Diffusion> = Cache::new();

/// Strength and width of the adjacency effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adjacency {
    /// Largest gain of contrast of fine patterns, 0 or more.
    pub gain: f64,
    /// Diffusion length, mm, above 0.
    pub length_mm: f64,
}

/// Fraction of the diffusing products that may lie outside the kernel, and largest radius of the kernel, pixels.
const BEYOND: f64 = 1e-4;
const LONGEST: usize = 1000;

/// Smallest number of cells per diffusion length; cells are as wide as this allows. Diffusion has reduced the fine patterns that cells lose
/// to a tenth, so the error is within 0.01 of the gain.
const CELLS_A_LENGTH: f64 = 2.0;

impl Adjacency {
    /// Returns the developed contrast of a sine of `frequency` cycles/mm, relative to development without adjacency effects.
    #[must_use]
    pub fn response(&self, frequency: f64) -> f64 {
        let x = 2.0 * PI * self.length_mm * frequency;
        1.0 + self.gain * (1.0 - 1.0 / (1.0 + x * x))
    }
}

/// Diffusion kernel prepared for planes of one size.
enum Diffusion {
    /// Diffusion from pixel to pixel.
    Pixels(Convolver<f32>, FromFrame),
    /// Diffusion from cell to cell: the width of a cell in pixels, the convolution, and for each cell the fraction of the kernel that lies
    /// on the frame.
    Cells(usize, Convolver<f32>, Vec<f32>),
}

impl Diffusion {
    fn on_pixels(kernel: &Kernel, raster: &Raster) -> Self {
        let (width, height) = (raster.width, raster.height);
        Self::Pixels(Convolver::new(kernel, width, height), FromFrame::new(kernel, [width, height]))
    }

    fn on_cells(kernel: &Kernel, raster: &Raster, cell_px: usize) -> Self {
        let size = [raster.width, raster.height];
        let [width, height] = size.map(|pixels| with_margin(pixels, cell_px));
        let convolver = Convolver::new(kernel, width, height);
        let mut even = Cells::of_pixels(&vec![1.0; raster.pixels()], size, cell_px, |v| v);
        even.convolve(&convolver);
        Self::Cells(cell_px, convolver, even.into_values())
    }
}

/// Fraction of the kernel around each pixel that lies on the frame: 1 except near the border. Interior pixels are equal, so a small frame
/// can hold all values.
struct FromFrame {
    frame: [usize; 2],
    small: [usize; 2],
    parts: Vec<f32>,
}

impl FromFrame {
    fn new(kernel: &Kernel, frame: [usize; 2]) -> Self {
        let most = 2 * kernel.radius() + 1;
        let small = frame.map(|side| side.min(most));
        let even = vec![1.0; small[0] * small[1]];
        let mut parts = vec![0.0; even.len()];
        let whole = kernel.sum() as f32;
        Convolver::<f32>::new(kernel, small[0], small[1]).apply(&even, &mut parts, |to, v| *to = v / whole);
        if small == [most; 2] {
            // Rounding must not change pixels far from the border at all.
            parts[most * kernel.radius() + kernel.radius()] = 1.0;
        }
        Self { frame, small, parts }
    }

    #[inline]
    fn at(&self, place: [usize; 2]) -> f32 {
        let fold = |axis: usize| {
            let (at, side, small) = (place[axis], self.frame[axis], self.small[axis]);
            let middle = small / 2;
            if at <= middle { at } else { middle.max((at + small).saturating_sub(side)) }
        };
        self.parts[fold(1) * self.small[0] + fold(0)]
    }
}

/// The adjacency effect on planes of one size.
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
    diffusion: Arc<Diffusion>,
}

impl Edges {
    /// Prepares the adjacency effect for planes of the size and pitch of `raster`.
    ///
    /// # Panics
    /// If the pixel pitch or the diffusion length is not positive and finite.
    #[must_use]
    pub fn new(adjacency: &Adjacency, raster: &Raster) -> Self {
        let good = |v: f64| v > 0.0 && v.is_finite();
        assert!(good(raster.pitch_mm) && good(adjacency.length_mm), "a pitch and a length above 0");
        let diffusion = DIFFUSIONS.get_or_compute((adjacency.length_mm, *raster), || {
            let mut cell_px = 1;
            while adjacency.length_mm >= 2.0 * CELLS_A_LENGTH * raster.pitch_mm * cell_px as f64 {
                cell_px *= 2;
            }
            let spread = PointSpread::bessel(adjacency.length_mm);
            let kernel = spread.over_pixels(raster.pitch_mm * cell_px as f64, BEYOND, LONGEST);
            let kernel = kernel.cropped(raster.width.max(raster.height));
            if cell_px == 1 {
                return Diffusion::on_pixels(&kernel, raster);
            }
            // A cell is wider than a pixel; the kernel already contains the variance of a twelfth of a squared pixel.
            let wide = cell_px as f64;
            let kernel = kernel.sharpened(BOTH_WAYS + (1.0 - 1.0 / (wide * wide)) / 24.0);
            Diffusion::on_cells(&kernel, raster, cell_px)
        });
        Self { raster: *raster, gain: adjacency.gain, diffusion }
    }

    /// Applies the effect to a plane of amounts (density of silver, or dye), in place. Film outside the frame is taken to be as dense as
    /// the frame's border, since mounts and masks cover the border that a camera's gate leaves.
    /// `range` holds the ends of the curve, within which amounts stay; `clear` is the amount of unexposed film. Needs memory for one more
    /// plane, or half of one if pixels are fine.
    ///
    /// # Panics
    /// If the number of pixels of the plane differs from that of the raster.
    pub fn apply(&self, amounts: &mut [f32], clear: f64, range: (f64, f64)) {
        assert_eq!(amounts.len(), self.raster.pixels(), "the plane has the size that was prepared for");
        let (gain, (low, high)) = (self.gain, range);
        let develop = |to: &mut f32, diffused: f32| {
            let here = f64::from(*to);
            let change = gain * (here - clear - f64::from(diffused));
            let room = if change < 0.0 { here - low } else { high - here };
            if room > 0.0 && change != 0.0 {
                *to = (here + change / (1.0 + change.abs() / room)) as f32;
            }
        };
        let over = |amount: f32| amount - clear as f32;
        match &*self.diffusion {
            Diffusion::Pixels(convolver, from_frame) => {
                let over: Vec<f32> = amounts.iter().map(|a| over(*a)).collect();
                convolver.apply_at(&over, amounts, |to, v, place| develop(to, v / from_frame.at(place)));
            }
            Diffusion::Cells(cell_px, convolver, from_frame) => {
                let size = [self.raster.width, self.raster.height];
                let mut cells = Cells::of_pixels(amounts, size, *cell_px, over);
                cells.convolve(convolver);
                cells.divide(from_frame);
                cells.over_pixels(amounts, self.raster.width, develop);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On cells, an edge, a dot and fine texture develop as on pixels, wherever they lie on the cells.
    #[test]
    fn cells_do_what_pixels_do() {
        let (width, height, pitch_mm) = (301, 203, 0.004);
        let adjacency = Adjacency { gain: 0.25, length_mm: 0.037 };
        let raster = Raster::new(width, height, pitch_mm);
        let edges = Edges::new(&adjacency, &raster);
        assert!(matches!(*edges.diffusion, Diffusion::Cells(4, ..)));
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
        let on_pixels = Edges { diffusion: Arc::new(Diffusion::on_pixels(&kernel, &raster)), ..edges };
        let mut want = plane.clone();
        on_pixels.apply(&mut want, 0.1, (0.0, 3.0));
        let most = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        println!("change {}, off by {}", most(&plane, &want), most(&got, &want));
        assert!(most(&plane, &want) > 0.05 && most(&got, &want) < 0.003);
    }

    /// An even frame stays even up to its border, on pixels and on cells.
    #[test]
    fn a_frame_has_no_rim() {
        for length_mm in [0.006, 0.05] {
            let raster = Raster::new(120, 80, 0.01);
            let edges = Edges::new(&Adjacency { gain: 0.25, length_mm }, &raster);
            assert_eq!(matches!(*edges.diffusion, Diffusion::Cells(..)), length_mm > 0.04);
            let mut plane = vec![1.3; raster.pixels()];
            edges.apply(&mut plane, 0.1, (0.0, 3.0));
            let off = plane.iter().map(|v| (v - 1.3).abs()).fold(0.0, f32::max);
            assert!(off < 1e-5, "{length_mm}: {off}");
        }
    }
}
