//! Tables that process whole frames as a single place is processed.

use super::{GamutLimit, PositiveKind};
use crate::cache::Cache;
use crate::cube::Cube;
use crate::deposit::Deposit;
use crate::lookup::PIXELS_A_TASK;
use rayon::prelude::*;
use spectra_core::isa::{Isa, Vectorized};
use spectra_core::math::log10;
use std::ops::Range;
use std::sync::Arc;

/// Steps of the tables over the amounts of three dyes. Densities of sums over the band are nearly linear in the amounts. Their second
/// derivative is the variance of the dye's density over the receiver's light, times ln 10: 0.2 or less. Over a range of 4 the error is 0.2
/// / 8 * (4 / 64)^2 = 1e-4 in density.
const STEPS: usize = 64;

/// Steps of the table over the amounts of a print. Light follows them without a steep curve between, and gamut mapping works on differences
/// of the light. The error is within 0.6 of a code value of 8 bits; with 64 steps it is within 1.6.
const PRINT_STEPS: usize = 96;

/// Steps of the picture of one silver layer, and its largest density. The picture's second derivative over density is below 60, so linear
/// interpolation is within 60 / 8 * (6 / 8192)^2 = 4e-6.
const SILVER_STEPS: usize = 8192;
const HIGHEST_DENSITY: f64 = 6.0;

/// Margin of the tables beyond the curves' amounts, because grain exceeds them.
const MARGIN: f64 = 0.15;

/// Range of log10 exposures over which the curves of a print are tabulated, and number of steps: the curves bend within hundredths of a
/// decade.
const EXPOSURES: f64 = 6.0;
const CURVE_STEPS: usize = 24_000;

/// Number of places that are processed together.
pub(super) const ROW: usize = 512;

#[derive(Clone, Debug)]
pub(super) enum Tables {
    /// One silver layer: the color shown for each density.
    Silver(Vec<[f32; 3]>),
    /// Three dye layers.
    Dyes(Box<Dyes>),
}

#[derive(Clone, Debug)]
pub(super) struct Dyes {
    /// Table from amounts of the film to densities of XYZ, of the scanner's channels, or of the exposures of the print's layers.
    first: Arc<Cube>,
    /// Amounts of the print's layers over log10 exposure; empty if nothing is printed.
    curves: Vec<Vec<f32>>,
    /// Table from amounts of a print of three dyes to densities of XYZ.
    last: Option<Arc<Cube>>,
    /// XYZ densities of the bare light.
    bare: [f32; 3],
    isa: Isa,
}

impl Tables {
    pub(super) fn new(film: &Deposit, ranges: &[(f64, f64)], way: &PositiveKind) -> Self {
        if film.layers() == 1 {
            return Self::silver(film, way, GamutLimit::Screen);
        }
        let ranges = [0, 1, 2].map(|i| (ranges[i].0 - MARGIN, ranges[i].1 + MARGIN));
        let (weights, printing) = match way {
            PositiveKind::Look(viewing) => (viewing.weights(), None),
            PositiveKind::Scan(scan) => (&scan.weights[..], None),
            PositiveKind::Print(printing) => (&printing.weights[..], Some(printing)),
        };
        let mut curves = Vec::new();
        let mut last = None;
        if let Some(printing) = printing {
            let print = &printing.emulsion;
            let layers = print.layers();
            let exposure = |k: usize| (2.0 * k as f64 / CURVE_STEPS as f64 - 1.0) * EXPOSURES;
            let curve = |i: usize| (0..=CURVE_STEPS).map(|k| print.amount(i, exposure(k)) as f32).collect();
            curves = (0..layers).map(curve).collect();
            if layers == 3 {
                let ranges = [0, 1, 2].map(|i| print.range(i));
                last = Some(densities(print.deposit(), ranges, printing.viewing.weights(), PRINT_STEPS));
            }
        }
        let bare = match printing {
            Some(printing) => [0, 1, 2].map(|i| -log10(printing.viewing.weights()[i].iter().sum::<f64>()) as f32),
            None => [0.0; 3],
        };
        let first = densities(film, ranges, weights, STEPS);
        Self::Dyes(Box::new(Dyes { first, curves, last, bare, isa: Isa::detect() }))
    }

    /// Builds the table of one silver layer.
    pub(super) fn silver(film: &Deposit, way: &PositiveKind, reach: GamutLimit) -> Self {
        Self::Silver(silver(film, way, reach))
    }

    /// Computes the picture; for silver, the range of values was fixed when the table was built.
    pub(super) fn picture(&self, planes: &[&[f32]], way: &PositiveKind, reach: GamutLimit) -> Vec<[f32; 3]> {
        match (self, planes) {
            (Self::Silver(table), [plane]) => {
                let scale = (SILVER_STEPS as f64 / HIGHEST_DENSITY) as f32;
                let one = |d: &f32| {
                    let p = (d * scale).max(0.0).min(SILVER_STEPS as f32);
                    let i = (p as usize).min(SILVER_STEPS - 1);
                    let (a, b, t) = (table[i], table[i + 1], p - i as f32);
                    [0, 1, 2].map(|c| a[c] + (b[c] - a[c]) * t)
                };
                plane.par_iter().with_min_len(PIXELS_A_TASK).map(one).collect()
            }
            (Self::Dyes(dyes), [a, b, c]) => {
                let mut picture = vec![[0.0; 3]; a.len()];
                picture.par_chunks_mut(PIXELS_A_TASK).enumerate().for_each(|(task, to)| {
                    let part =
                        |plane: &'_ [f32]| task * PIXELS_A_TASK..(task * PIXELS_A_TASK + to.len()).min(plane.len());
                    let planes = [&a[part(a)], &b[part(b)], &c[part(c)]];
                    dyes.isa.run(Shown { dyes, planes, way, reach, to });
                });
                picture
            }
            // There are as many planes as layers, because both belong to the same film.
            _ => Vec::new(),
        }
    }
}

/// Computes the amounts in the `layers` of a print from the places of a film, given as a plane per layer. `of_silver` returns the amounts
/// for one density of silver.
pub(super) fn printed(
    tables: &Tables,
    layers: usize,
    of_silver: &(dyn Fn(f64) -> Vec<f64> + Sync),
    planes: &[&[f32]],
) -> Vec<Vec<f32>> {
    let places = planes.first().map_or(0, |plane| plane.len());
    let mut printed: Vec<Vec<f32>> = (0..layers).map(|_| Vec::with_capacity(places)).collect();
    match (tables, planes) {
        (Tables::Dyes(dyes), [a, b, c]) => {
            for ((a, b), c) in a.iter().zip(*b).zip(*c) {
                let seen = dyes.first.at([*a, *b, *c]);
                for (layer, to) in printed.iter_mut().enumerate() {
                    to.push(along_curve(&dyes.curves[layer], seen[layer]));
                }
            }
        }
        (_, [silver]) => {
            let at = |i: usize| of_silver(i as f64 / SILVER_STEPS as f64 * HIGHEST_DENSITY);
            let table: Vec<Vec<f64>> = (0..SILVER_STEPS + 1).into_par_iter().with_min_len(256).map(at).collect();
            for d in *silver {
                let place = (f64::from(*d) * SILVER_STEPS as f64 / HIGHEST_DENSITY).clamp(0.0, SILVER_STEPS as f64);
                let i = (place as usize).min(SILVER_STEPS - 1);
                for (layer, to) in printed.iter_mut().enumerate() {
                    let (a, b) = (table[i][layer], table[i + 1][layer]);
                    to.push((a + (b - a) * (place - i as f64)) as f32);
                }
            }
        }
        // There are as many planes as layers, because both belong to the same film.
        _ => {}
    }
    printed
}

/// Returns the amount of a layer for an exposure, given as minus its logarithm: linear between samples.
#[inline(always)]
fn along_curve(curve: &[f32], density: f32) -> f32 {
    const PER_STEP: f32 = CURVE_STEPS as f32 / (2.0 * EXPOSURES as f32);
    let place = ((EXPOSURES as f32 - density) * PER_STEP).max(0.0).min(CURVE_STEPS as f32);
    let k = (place as i32 as usize).min(CURVE_STEPS - 1);
    curve[k] + (curve[k + 1] - curve[k]) * (place - k as f32)
}

/// A run of places that is converted from amounts of dye to the screen.
struct Shown<'a> {
    dyes: &'a Dyes,
    planes: [&'a [f32]; 3],
    way: &'a PositiveKind,
    reach: GamutLimit,
    to: &'a mut [[f32; 3]],
}

impl Vectorized for Shown<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { dyes, planes: [a, b, c], way, reach, to } = self;
        let (mut row, mut found) = ([[0.0_f32; ROW]; 3], [[0.0_f32; 4]; ROW]);
        for (k, to) in to.chunks_mut(ROW).enumerate() {
            let part = k * ROW..k * ROW + to.len();
            let places = a[part.clone()].iter().zip(&b[part.clone()]).zip(&c[part]);
            for (found, ((a, b), c)) in found.iter_mut().zip(places) {
                *found = dyes.first.at([*a, *b, *c]);
            }
            turned(&found, &mut row);
            match way {
                PositiveKind::Look(viewing) => viewing.shown_row(&mut row, reach, to),
                PositiveKind::Scan(scan) => {
                    for (i, to) in to.iter_mut().enumerate() {
                        let densities = [0, 1, 2].map(|k| f64::from(row[k][i]));
                        *to = scan.shown_in(&densities, reach).map(|v| v as f32);
                    }
                }
                PositiveKind::Print(printing) => {
                    dyes.print(&mut row, &mut found, to.len());
                    printing.viewing.shown_row(&mut row, reach, to);
                }
            }
        }
    }
}

/// Transposes the densities of a row of places.
#[inline(always)]
fn turned(found: &[[f32; 4]; ROW], row: &mut [[f32; ROW]; 3]) {
    for (i, [a, b, c, _]) in found.iter().enumerate() {
        (row[0][i], row[1][i], row[2][i]) = (*a, *b, *c);
    }
}

impl Dyes {
    /// Converts the exposures of the layers of a print to XYZ densities, for `count` places.
    #[inline(always)]
    fn print(&self, row: &mut [[f32; ROW]; 3], found: &mut [[f32; 4]; ROW], count: usize) {
        for (line, curve) in row.iter_mut().zip(&self.curves) {
            line[..count].iter_mut().for_each(|d| *d = along_curve(curve, *d));
        }
        let Some(last) = &self.last else {
            // Silver has the same density in X, Y and Z.
            let silver = row[0];
            for (line, bare) in row.iter_mut().zip(self.bare) {
                line.iter_mut().zip(&silver).for_each(|(to, d)| *to = d + bare);
            }
            return;
        };
        for (i, found) in found[..count].iter_mut().enumerate() {
            *found = last.at([row[0][i], row[1][i], row[2][i]]);
        }
        turned(found, row);
    }
}

fn silver(film: &Deposit, way: &PositiveKind, reach: GamutLimit) -> Vec<[f32; 3]> {
    let one = |i: usize| {
        let amounts = [i as f64 / SILVER_STEPS as f64 * HIGHEST_DENSITY];
        let shown = match way {
            PositiveKind::Look(viewing) => viewing.shown_in(viewing.xyz(film, &amounts), reach),
            PositiveKind::Print(printing) => printing.viewing.shown_in(printing.xyz(film, &amounts), reach),
            PositiveKind::Scan(scan) => scan.shown_in(&scan.densities(film, &amounts), reach),
        };
        shown.map(|v| v as f32)
    };
    (0..SILVER_STEPS + 1).into_par_iter().with_min_len(256).map(one).collect()
}

/// Computes the densities that three receivers measure at each place of three dyes.
pub(super) fn seen(film: &Deposit, ranges: &[(f64, f64)], weights: &[Vec<f64>], planes: [&[f32]; 3]) -> Vec<[f32; 3]> {
    let ranges = [0, 1, 2].map(|i| (ranges[i].0 - MARGIN, ranges[i].1 + MARGIN));
    let cube = densities(film, ranges, weights, STEPS);
    let [a, b, c] = planes;
    let pixels = a.par_iter().zip(b.par_iter()).zip(c.par_iter()).with_min_len(PIXELS_A_TASK);
    pixels.map(|((a, b), c)| cube.at([*a, *b, *c])).map(|[a, b, c, _]| [a, b, c]).collect()
}

/// Cache key: the dyes, the ranges of the amounts, the receivers' weights, and the number of steps.
type DensityCacheKey = (Deposit, [(f64, f64); 3], Vec<Vec<f64>>, usize);

/// Cache for two prints: from a negative to the print's layers, and from the print to the eye.
static KNOWN: Cache<DensityCacheKey, Cube> = Cache::keeping(4);

/// Returns the densities that up to three receivers measure, over the amounts of three dyes.
fn densities(deposit: &Deposit, ranges: [(f64, f64); 3], weights: &[Vec<f64>], steps: usize) -> Arc<Cube> {
    let key = (deposit.clone(), ranges, weights.to_vec(), steps);
    KNOWN.get_or_compute(key, || summed(deposit, ranges, weights, steps))
}

/// Computes [`densities`] without the cache.
fn summed(deposit: &Deposit, ranges: [(f64, f64); 3], weights: &[Vec<f64>], steps: usize) -> Cube {
    let place = |k: usize, i: usize| ranges[k].0 + (ranges[k].1 - ranges[k].0) * i as f64 / steps as f64;
    let passed =
        |k: usize| -> Vec<Vec<f64>> { (0..=steps).map(|i| deposit.layer_transmittance(k, place(k, i))).collect() };
    let layers = [passed(0), passed(1)];
    let thirds: Vec<Columns> = passed(2).chunks(COLUMNS).map(columns).collect();
    let base = deposit.base_transmittance();
    // Wavelengths at which a receiver has no weight are skipped.
    let parts: Vec<Range<usize>> = weights
        .iter()
        .take(3)
        .map(|weight| {
            let from = weight.iter().position(|w| *w != 0.0).unwrap_or(0);
            from..weight.iter().rposition(|w| *w != 0.0).map_or(from, |last| last + 1)
        })
        .collect();
    let isa = Isa::detect();
    Cube::by_slabs(ranges, steps, |i, to| {
        for (j, row) in to.chunks_mut(steps + 1).enumerate() {
            let both: Vec<f64> =
                base.iter().zip(&layers[0][i]).zip(&layers[1][j]).map(|((b, x), y)| b * x * y).collect();
            for (channel, (weight, part)) in weights.iter().zip(&parts).enumerate() {
                let weighed: Vec<f64> =
                    both[part.clone()].iter().zip(&weight[part.clone()]).map(|(b, w)| b * w).collect();
                for (third, to) in thirds.iter().zip(row.chunks_mut(COLUMNS)) {
                    let sums = isa.run(Sums { weighed: &weighed, columns: &third[part.clone()] });
                    to.iter_mut().zip(sums).for_each(|(value, sum)| value[channel] = -log10(sum) as f32);
                }
            }
        }
    })
}

/// Number of amounts of the third dye that are summed over the band together.
const COLUMNS: usize = 24;

/// Transmittance of this many amounts of a dye, at each wavelength.
type Columns = Vec<[f64; COLUMNS]>;

/// Transposes a few spectra.
fn columns(spectra: &[Vec<f64>]) -> Columns {
    let at = |w: usize| std::array::from_fn(|i| spectra.get(i).map_or(1.0, |spectrum| spectrum[w]));
    (0..spectra[0].len()).map(at).collect()
}

/// Sums of products over the band, each in the order of wavelengths.
struct Sums<'a> {
    weighed: &'a [f64],
    columns: &'a [[f64; COLUMNS]],
}

impl Vectorized for Sums<'_> {
    type Output = [f64; COLUMNS];
    #[inline(always)]
    fn run(self) -> Self::Output {
        let mut sums = [0.0; COLUMNS];
        for (weight, passes) in self.weighed.iter().zip(self.columns) {
            for i in 0..COLUMNS {
                sums[i] += weight * passes[i];
            }
        }
        sums
    }
}
