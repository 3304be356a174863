//! Grain: developed silver as grains that lie at random, calibrated by RMS granularity.
//!
//! **Model.** P. G. Nutting ("On the absorption of light in heterogeneous media", Philosophical Magazine 26, 1913, 423):
//! n grains an area, each of the area a, make the density D = log10(e) n a. Grains at random are counted by Poisson's law, so
//! the density over an area A has the variance log10(e) a D / A: the standard deviation grows with the square root of
//! the density, and times the square root of the area it is constant (E. W. H. Selwyn, "A theory of graininess",
//! Photographic Journal 75, 1935, 571). The one constant a comes from the RMS granularity of the maker's sheet: 1000 times
//! the standard deviation through a circular aperture of 48 um at the density 1. It is an effective area, clumps
//! and the spread of grain sizes included.
//!
//! **The same film at every zoom.** The grains lie on a square lattice fixed in the film, of cells as wide as an
//! effective grain. Each cell has a standard normal number, a pure function of (seed, layer, place), drawn from the top down: a
//! cell's number and three of its own are turned into those of its four quarters by an orthogonal transform, so all
//! cells of all levels are consistent, and a coarse cell is known without its fine ones. A pixel takes the cells
//! that it covers by exact areas (a quadratic B-spline a cell, so that no edges show) from the level that suits its size: the
//! cost is that of pixels, not of cells. Its number of grains is then the quantile of Poisson's law that belongs to its normal
//! number, with the mean that its density asks for: never negative, skew in the shadows, the mean density unchanged.
//!
//! **Limits.** Pixels that are much finer than a grain show soft blobs, not the shapes of grains. Counts of
//! neighboring pixels are tied by their normal numbers, not by splitting one count. So means over 48 um of the same film
//! at two resolutions are correlated by 0.99 and more at the density 1, but by about 0.97 at the density 0.1, where pixels
//! finer than grains hold about one each. Layers are independent.

mod calibrate;
mod count;
mod field;
mod spline;

pub use calibrate::{APERTURE_MM, GrainError};

use crate::raster::Raster;
use count::Counts;
use field::{Cells, Field};
use rayon::prelude::*;
use spectra_core::isa::{Isa, Vectorized};
use spline::Taps;

/// Side of the tiles that are worked on at once, pixels.
const TILE: usize = 64;

/// Cells a pixel from which on the next coarser level is taken: the level has between this and twice this.
const CELLS_A_PIXEL: f64 = 4.0;

/// The grain of one layer.
///
/// ```
/// use spectra_film::grain::Grain;
/// use spectra_film::raster::Raster;
/// let grain = Grain::calibrated(17.0, 1, 0)?; // Kodak Tri-X 400
/// let raster = Raster::new(96, 64, 0.006);
/// let mut density = vec![1.0; raster.pixels()];
/// grain.apply(&mut density, &raster);
/// // A part of the frame is the same film.
/// let mut part = vec![1.0; 10 * 10];
/// grain.apply(&mut part, &raster.part(50, 20, 10, 10));
/// assert_eq!(part[0], density[20 * 96 + 50]);
/// # Ok::<(), spectra_film::grain::GrainError>(())
/// ```
pub struct Grain {
    /// Variance of the density 1 over the area 1 mm^2: log10(e) times the grain's area, mm^2.
    selwyn_mm2: f64,
    /// Side of a cell of the finest level, mm.
    cell_mm: f64,
    field: Field,
    counts: Counts,
    isa: Isa,
}

impl Grain {
    /// Grain whose standard deviation through a circular aperture of 48 um is `rms_granularity` / 1000 at the density 1,
    /// for instance 17 of Kodak Tri-X 400 or 14 of Eastman Double-X 5222. Layers of a film share the `seed` and differ in
    /// `layer`. A granularity of 0 is no grain.
    ///
    /// # Errors
    /// [`GrainError`] for a granularity beside 0 to 200.
    pub fn calibrated(rms_granularity: f64, seed: u64, layer: u32) -> Result<Self, GrainError> {
        let calibration = calibrate::calibrate(rms_granularity)?;
        Ok(Self {
            selwyn_mm2: calibration.selwyn_mm2,
            cell_mm: calibration.cell_mm,
            field: Field::new(seed, layer),
            counts: Counts::new(),
            isa: Isa::detect(),
        })
    }

    /// Replaces a plane of density (over base and fog) by that of its grains, in place. The mean stays.
    ///
    /// The result of a pixel depends on its own density and its place on the film alone: any cut into tiles gives the
    /// same bits. Densities of 0 and less, and no numbers, stay as they are, and so does all where the
    /// pitch is not positive and finite. Memory: some tiles.
    ///
    /// # Panics
    /// If the plane has another number of pixels than the raster.
    pub fn apply(&self, density: &mut [f32], raster: &Raster) {
        assert_eq!(density.len(), raster.pixels(), "the plane has the size of its raster");
        let good_pitch = raster.pitch_mm > 0.0 && raster.pitch_mm.is_finite();
        if self.selwyn_mm2 == 0.0 || density.is_empty() || !good_pitch {
            return;
        }
        let (level, cells_a_pixel) = self.level(raster.pitch_mm);
        let columns = Taps::new(raster.offset_px[0], raster.width, cells_a_pixel);
        density.par_chunks_mut(raster.width * TILE).enumerate().for_each_init(
            Cells::default,
            |cells, (strip, plane)| {
                let first = raster.offset_px[1] + (strip * TILE) as i64;
                let rows = Taps::new(first, plane.len() / raster.width, cells_a_pixel);
                self.isa.run(Strip {
                    grain: self,
                    level,
                    cells_a_pixel,
                    pitch_mm: raster.pitch_mm,
                    columns: &columns,
                    rows: &rows,
                    cells,
                    plane,
                });
            },
        );
    }

    /// The level whose cells suit a pixel, and how many of them it has along a side.
    fn level(&self, pitch_mm: f64) -> (u32, f64) {
        let mut level = 0;
        let mut cells_a_pixel = pitch_mm / self.cell_mm;
        while cells_a_pixel >= 2.0 * CELLS_A_PIXEL && level < field::TOP {
            level += 1;
            cells_a_pixel /= 2.0;
        }
        (level, cells_a_pixel)
    }
}

/// Rows of tiles.
struct Strip<'a> {
    grain: &'a Grain,
    level: u32,
    cells_a_pixel: f64,
    pitch_mm: f64,
    columns: &'a Taps,
    rows: &'a Taps,
    cells: &'a mut Cells,
    plane: &'a mut [f32],
}

impl Vectorized for Strip<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { grain, columns, rows, cells, plane, .. } = self;
        let width = columns.len();
        // Variance of the density 1 over a pixel, were all its cells taken whole.
        let variance = grain.selwyn_mm2 * (self.cells_a_pixel / self.pitch_mm) * (self.cells_a_pixel / self.pitch_mm);
        let area = (self.cells_a_pixel * self.cells_a_pixel) as f32;
        let mut line = Vec::new();
        for from in (0..width).step_by(TILE) {
            let to = (from + TILE).min(width);
            let (x, across) = columns.cells(from, to);
            let (y, down) = rows.cells(0, rows.len());
            grain.field.fill(self.level, [x, y], [across, down], cells);
            line.clear();
            line.resize(across, 0.0_f32);
            for row in 0..rows.len() {
                line.fill(0.0);
                let (first, weights) = rows.of(row);
                for (t, w) in weights.iter().enumerate() {
                    let cells = &cells.row(first + t as i64, x)[..across];
                    for (sum, z) in line.iter_mut().zip(cells) {
                        *sum += w * z;
                    }
                }
                for column in from..to {
                    let density = &mut plane[row * width + column];
                    if !(*density > 0.0 && density.is_finite()) {
                        continue;
                    }
                    let (first, weights) = columns.of(column);
                    let sum: f32 = weights.iter().zip(&line[(first - x) as usize..]).map(|(w, z)| w * z).sum();
                    let squares = rows.square(row) * columns.square(column);
                    // A grain's density in this pixel, and the grains that are expected.
                    let one = (variance * f64::from(squares)) as f32;
                    let mean = grain.counts.evened(*density / one, (squares * area).min(1.0));
                    *density *= grain.counts.quantile(mean, sum / squares.sqrt()) / mean;
                }
            }
        }
    }
}
