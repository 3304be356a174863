//! Grain: developed silver, or clouds of dye, that lie at random and in clumps, calibrated by RMS granularity.
//!
//! **Model.** In P. G. Nutting's model ("On the absorption of light in heterogeneous media", Philosophical Magazine 26, 1913, 423), n
//! grains per area, each of the area a, give the density D = log10(e) n a.
//! The counts of random grains follow Poisson's law, so the density over an area A has the variance log10(e) a D / A. The standard
//! deviation grows with the square root of the density.
//! Its product with the square root of the area is constant (E. W. H. Selwyn, "A theory of graininess", Photographic Journal 75, 1935,
//! 571).
//! This constant comes from the RMS granularity of the maker's sheet: 1000 times the standard deviation through a circular aperture of 48
//! um at the density 1. If a sheet plots granularity over density, as for color film, the variance follows the plot
//! ([`Grain::by_density`]).
//!
//! **Clumps.** Crystals lie in clumps several times their width, so the noise is not white. Its Wiener spectrum (variance times area, over
//! spatial frequency) falls to half at 20 to 60 cycles/mm and on to a foot, which is that of single crystals.
//! Sources: J. H. Altman and H. J. Zweig, "Effect of spread function on the storage of information on photographic emulsions", Photographic
//! Science and Engineering 7, 1963, 173; C. E. K. Mees and T. H. James, "The Theory of the Photographic Process", 3rd edition, 1966, on
//! granularity.
//! Here the spectrum is the sum of two parts: 0.88 of clumps, and 0.12 of crystals a fifth as wide. The frequency of half power is given.
//! Small apertures see less noise than Selwyn's law predicts from large ones, as on film.
//!
//! **The same film at every zoom.** Clumps and crystals lie on square lattices fixed in the film. Each cell has a standard normal number, a
//! pure function of (seed, layer, place), drawn from the coarsest level down.
//! An orthogonal transform turns a cell's number and three further numbers into those of its four quarters. So all cells of all levels are
//! consistent, and a coarse cell is known without its fine ones.
//! A pixel takes the cells that it covers by exact areas (a quadratic B-spline per cell, so that no edges show) from the level that suits
//! its size: the cost is that of pixels, not of cells.
//! Its number of grains is the quantile of Poisson's law for its normal number, with the mean that its density and variance require. It is
//! never negative, is skewed in the shadows, and keeps the mean density.
//!
//! **Limits.** Pixels much finer than a crystal show soft blobs, not the shapes of grains. Counts of neighboring pixels are correlated by
//! their normal numbers, not by splitting one count. So two resolutions of the same film agree less where grains are few. Layers are
//! independent.

mod calibrate;
mod color;
mod count;
mod field;
mod pixels;
mod spline;

pub use calibrate::{APERTURE_MM, GrainError};
pub use color::{ColorGrain, FOG};

use crate::cache::Cache;
use crate::raster::Raster;
use count::Counts;
use field::{Cells, Field};
use pixels::Pixels;
use rayon::prelude::*;
use spectra_core::isa::{Isa, Vectorized};
use spline::Taps;

/// Side of the square tiles that are processed at once, pixels.
const TILE: usize = 64;

/// Cells per pixel at which the next coarser level is used, for clumps and for crystals. The level in use has between this and twice this
/// number.
const CELLS_A_PIXEL: [f64; 2] = [4.0, 2.0];

/// RMS granularity, and cycles/mm at which the Wiener spectrum is at half, of a grainy film. Other films are scaled from it: the finer the
/// grain, the farther the spectrum extends, in proportion. Assumed.
const USUAL: [f64; 2] = [17.0, 35.0];

/// Number of steps of the variance over the amount.
const STEPS: usize = 1024;

/// Estimates the half-power frequency of the grain, in cycles/mm, for a film of which it is not known: the frequency at which the
/// Wiener spectrum has fallen to half. It is assumed to be inversely proportional to the RMS granularity `rms`. The scale is that
/// of Kodak Tri-X 400, with 35 cycles/mm at a granularity of 17; results are limited to 20 to 100.
#[must_use]
pub fn usual_half_power(rms: f64) -> f64 {
    (USUAL[0] * USUAL[1] / rms).clamp(20.0, 100.0)
}

/// The grain of one layer.
///
/// ```
/// use spectra_film::grain::Grain;
/// use spectra_film::raster::Raster;
/// let grain = Grain::calibrated(17.0, 35.0, 1, 0)?; // Kodak Tri-X 400
/// let raster = Raster::new(96, 64, 0.006);
/// let mut density = vec![1.0; raster.pixels()];
/// grain.apply(&mut density, &raster);
/// // A part of the frame has the same grain.
/// let mut part = vec![1.0; 10 * 10];
/// grain.apply(&mut part, &raster.part(50, 20, 10, 10));
/// assert_eq!(part[0], density[20 * 96 + 50]);
/// # Ok::<(), spectra_film::grain::GrainError>(())
/// ```
pub struct Grain {
    /// Variance times area of large areas (mm^2), divided by the amount, at each of [`STEPS`] steps up to the largest amount.
    per_amount: Vec<f32>,
    steps_a_unit: f32,
    parts: [GrainComponent; 2],
    counts: &'static Counts,
    isa: Isa,
}

/// One of the two parts of the noise: clumps, or crystals.
struct GrainComponent {
    /// Fraction of the variance of large areas.
    share: f64,
    /// Side of a cell of the finest level, mm.
    cell_mm: f64,
    field: Field,
}

impl Grain {
    /// Builds grain whose standard deviation through a circular aperture of 48 um is `rms_granularity` / 1000 at the density 1, for example
    /// 17 for Kodak Tri-X 400 or 14 for Eastman Double-X 5222.
    ///
    /// The deviation grows with the square root of the density. The Wiener spectrum is at half at `half_power` cycles/mm. Layers of a film
    /// share the `seed` and differ in `layer`. A granularity of 0 gives no grain.
    ///
    /// # Errors
    /// [`GrainError`] for a granularity outside 0 to 200, or a frequency outside 1 to 1000.
    pub fn calibrated(rms_granularity: f64, half_power: f64, seed: u64, layer: u32) -> Result<Self, GrainError> {
        Self::by_density(|density| rms_granularity * density.sqrt(), 1.0, half_power, seed, layer)
    }

    /// Builds grain whose standard deviation through a circular aperture of 48 um, times 1000, is `rms(amount)`. `amount` is
    /// silver or dye above zero, up to `most`. Beyond `most`, the deviation grows with the square root of the amount.
    ///
    /// `half_power` is the frequency in cycles/mm at which the Wiener spectrum falls to half. Layers of a film share the `seed`
    /// and differ in `layer`.
    ///
    /// # Errors
    /// [`GrainError`] for a granularity outside 0 to 200, or a frequency outside 1 to 1000.
    pub fn by_density(
        rms: impl Fn(f64) -> f64,
        most: f64,
        half_power: f64,
        seed: u64,
        layer: u32,
    ) -> Result<Self, GrainError> {
        let clump_mm = calibrate::clump_mm(half_power)?;
        let selwyn_mm2 = calibrate::selwyn_mm2(clump_mm);
        let mut per_amount = Vec::with_capacity(STEPS + 1);
        for step in 0..STEPS + 1 {
            // Toward zero, the deviation falls as the square root of the amount.
            let amount = most * (step.max(1) as f64) / STEPS as f64;
            let rms = rms(amount);
            if !(0.0..=200.0).contains(&rms) {
                return Err(GrainError::OutOfRange(rms));
            }
            per_amount.push(((rms / 1e3) * (rms / 1e3) * selwyn_mm2 / amount) as f32);
        }
        let part = |share: f64, cell_mm: f64, which: u32| GrainComponent {
            share,
            cell_mm,
            field: Field::new(seed, layer + which),
        };
        let parts = [
            part(1.0 - calibrate::CRYSTALS, clump_mm, 0),
            part(calibrate::CRYSTALS, clump_mm / calibrate::CLUMP, 1 << 16),
        ];
        Ok(Self {
            per_amount,
            steps_a_unit: STEPS as f32 / most as f32,
            parts,
            counts: Counts::all(),
            isa: Isa::detect(),
        })
    }

    /// Returns the Wiener spectrum at `frequency` cycles/mm along an axis, relative to its value at 0.
    #[must_use]
    pub fn wiener(&self, frequency: f64) -> f64 {
        calibrate::wiener(frequency * self.parts[0].cell_mm)
    }

    /// Variance times area of large areas (mm^2) at an amount, divided by the amount.
    #[inline(always)]
    fn per_amount(&self, amount: f32) -> f32 {
        let place = amount * self.steps_a_unit;
        let k = place as usize;
        if k >= STEPS {
            return self.per_amount[STEPS];
        }
        self.per_amount[k] + (self.per_amount[k + 1] - self.per_amount[k]) * (place - k as f32)
    }

    /// Replaces a plane of density (above base and fog) by that of its grains, in place. The mean stays.
    ///
    /// The result of a pixel depends only on its own density and its place on the film: any cut into tiles gives the same bits.
    /// Densities that are not positive, and NaN, do not change. Nothing changes if the pitch is not positive, or is several meters. Memory:
    /// a few tiles.
    ///
    /// # Panics
    /// If the number of pixels of the plane differs from that of the raster.
    pub fn apply(&self, density: &mut [f32], raster: &Raster) {
        assert_eq!(density.len(), raster.pixels(), "the plane has the size of its raster");
        let good_pitch = raster.pitch_mm > 0.0 && raster.pitch_mm.is_finite();
        if self.per_amount.iter().all(|v| *v == 0.0) || density.is_empty() || !good_pitch {
            return;
        }
        let layouts = [0, 1].map(|part| self.layout(part, raster));
        if layouts.iter().any(|layout| layout.columns.taps() > MOST_TAPS) {
            return;
        }
        let variance = pixel_variance(&layouts);
        let alone = (variance * (raster.pitch_mm * raster.pitch_mm) as f32).min(1.0);
        let made = || Pixels::new(self.counts, alone, |density| self.per_amount(density) * variance);
        let key = (self.per_amount.clone(), [self.steps_a_unit.to_bits(), variance.to_bits(), alone.to_bits()]);
        let pixels = &*PIXELS.get_or_compute(key, made);
        density.par_chunks_mut(raster.width * TILE).enumerate().for_each_init(
            || [Lines::new(), Lines::new()],
            |lines, (strip, plane)| {
                let first = raster.offset_px[1] + (strip * TILE) as i64;
                let rows = |l: &Layout| Taps::new(first, plane.len() / raster.width, l.cells_a_pixel);
                let rows = [rows(&layouts[0]), rows(&layouts[1])];
                let strip =
                    Strip { grain: self, layouts: &layouts, rows: &rows, variance, alone, pixels, lines, plane };
                self.isa.run(strip);
            },
        );
    }

    /// Returns the standard deviation of the density of pixels with the side `pitch_mm`, where the density above base and fog is `amount`.
    #[must_use]
    pub fn deviation(&self, amount: f64, pitch_mm: f64) -> f64 {
        let raster = Raster::new(TILE, 1, pitch_mm);
        let variance = f64::from(pixel_variance(&[0, 1].map(|part| self.layout(part, &raster))));
        (f64::from(self.per_amount(amount.max(0.0) as f32)) * variance * amount.max(0.0)).sqrt()
    }

    /// Chooses the level of a part whose cells suit a pixel, and computes the cells that each column of pixels takes.
    fn layout(&self, part: usize, raster: &Raster) -> Layout {
        let GrainComponent { share, cell_mm, .. } = &self.parts[part];
        let mut level = 0;
        let mut cells_a_pixel = raster.pitch_mm / cell_mm;
        while cells_a_pixel >= 2.0 * CELLS_A_PIXEL[part] && level < field::TOP {
            level += 1;
            cells_a_pixel /= 2.0;
        }
        let cell_mm = raster.pitch_mm / cells_a_pixel;
        let columns = Taps::new(raster.offset_px[0], raster.width, cells_a_pixel);
        Layout { level, cells_a_pixel, weight: (share.sqrt() / cell_mm) as f32, columns }
    }
}

/// Returns the variance of a pixel if the variance times the area of large areas is 1 mm^2, 1/mm^2.
fn pixel_variance(layouts: &[Layout; 2]) -> f32 {
    layouts.iter().map(|l| l.weight * l.weight * l.columns.mean_square() * l.columns.mean_square()).sum()
}

/// Position of a part's cells under the pixels.
struct Layout {
    level: u32,
    cells_a_pixel: f64,
    /// Square root of the part's share over the side of a cell, 1/mm.
    weight: f32,
    columns: Taps,
}

/// Cache of tables for pixels of one size, by the grain's variances and the pixel's.
static PIXELS: Cache<(Vec<f32>, [u32; 3]), Pixels> = Cache::new();

/// Largest number of cells that a pixel takes along an axis: eight from its start to its end, and those that reach in.
const MOST_TAPS: usize = 11;

/// Number of cells along a tile for which a line has room: 64 pixels take 8 each, and those that reach in.
const LINE: usize = 1024;

/// One row of tiles.
struct Strip<'a> {
    grain: &'a Grain,
    layouts: &'a [Layout; 2],
    rows: &'a [Taps; 2],
    /// `variance`: variance of a pixel if the variance times the area of large areas is 1 mm^2, in 1/mm^2. `alone`: the fraction of
    /// large-area variance that the pixel has on its own.
    variance: f32,
    alone: f32,
    pixels: &'a Pixels,
    lines: &'a mut [Lines; 2],
    plane: &'a mut [f32],
}

/// The cells of a tile, and the weights that its columns of pixels give them.
struct Lines {
    cells: Cells,
    /// First column of the cells, and number of columns.
    x: i64,
    across: usize,
    /// First cell of each column of pixels, counted from `x`, and its weights, tap by tap.
    first: [u32; TILE],
    weights: [[f32; TILE]; MOST_TAPS],
    evening: [f32; TILE],
    /// Sums of the cells of a row of pixels.
    line: [f32; LINE],
}

impl Lines {
    fn new() -> Self {
        Self {
            cells: Cells::default(),
            x: 0,
            across: 0,
            first: [0; TILE],
            weights: [[0.0; TILE]; MOST_TAPS],
            evening: [0.0; TILE],
            line: [0.0; LINE],
        }
    }

    /// Loads the cells and weights of a part for the columns `from` up to but not including `to`.
    #[inline(always)]
    fn fill(&mut self, part: &GrainComponent, layout: &Layout, rows: &Taps, [from, to]: [usize; 2]) {
        let (x, across) = layout.columns.cells(from, to);
        let (y, down) = rows.cells(0, rows.len());
        part.field.fill(layout.level, [x, y], [across, down], &mut self.cells);
        (self.x, self.across) = (x, across.min(LINE));
        for column in 0..TILE {
            // Columns outside the plane repeat its last one.
            let on_plane = (from + column).min(to - 1);
            let (first, weights) = layout.columns.of(on_plane);
            self.first[column] = (first - x) as u32;
            self.evening[column] = layout.columns.evening(on_plane);
            for (to, weight) in self.weights.iter_mut().zip(weights) {
                to[column] = *weight;
            }
        }
    }

    /// Adds the normal numbers of a row of pixels, multiplied by `factor`, to `numbers`.
    #[inline(always)]
    fn add(&mut self, rows: &Taps, row: usize, factor: f32, numbers: &mut [f32; TILE]) {
        // Sums the cells down each column of cells.
        let line = &mut self.line[..self.across];
        line.fill(0.0);
        let (first, weights) = rows.of(row);
        for (t, w) in weights.iter().enumerate() {
            let cells = &self.cells.row(first + t as i64, self.x)[..line.len()];
            for (sum, z) in line.iter_mut().zip(cells) {
                *sum += w * z;
            }
        }
        let factor = factor * rows.evening(row);
        let mut sums = [0.0; TILE];
        for (t, weights) in self.weights.iter().enumerate().take(rows.taps()) {
            for column in 0..TILE {
                sums[column] += weights[column] * self.line[(self.first[column] + t as u32) as usize % LINE];
            }
        }
        for column in 0..TILE {
            numbers[column] += sums[column] * self.evening[column] * factor;
        }
    }
}

/// Computes the density that [`Pixels::at`] cannot look up.
#[inline(never)]
fn grainy_density(grain: &Grain, [variance, alone]: [f32; 2], density: f32, number: f32) -> f32 {
    // The density of one grain in this pixel.
    let one = grain.per_amount(density) * variance;
    if !(density > 0.0 && density.is_finite() && one > 0.0) {
        return density;
    }
    let mean = grain.counts.evened(density / one, alone);
    density * grain.counts.quantile(mean, number) / mean
}

impl Vectorized for Strip<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { grain, layouts, rows, variance, alone, pixels, lines, plane } = self;
        let deviation = variance.sqrt();
        let width = layouts[0].columns.len();
        for from in (0..width).step_by(TILE) {
            let to = (from + TILE).min(width);
            for part in 0..2 {
                lines[part].fill(&grain.parts[part], &layouts[part], &rows[part], [from, to]);
            }
            for row in 0..rows[0].len() {
                let plane = &mut plane[row * width + from..row * width + to];
                let mut numbers = [0.0; TILE];
                for part in 0..2 {
                    lines[part].add(&rows[part], row, layouts[part].weight / deviation, &mut numbers);
                }
                let (mut densities, mut grainy) = ([0.0; TILE], [0.0; TILE]);
                densities[..plane.len()].copy_from_slice(plane);
                for column in 0..TILE {
                    grainy[column] = pixels.at(densities[column], numbers[column]);
                }
                for (column, to) in plane.iter_mut().enumerate() {
                    let here = grainy[column];
                    *to = if here.is_nan() {
                        grainy_density(grain, [variance, alone], *to, numbers[column])
                    } else {
                        here
                    };
                }
            }
        }
    }
}
