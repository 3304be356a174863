//! Tables by which whole frames go the way of one place.

use super::{Reach, Way};
use crate::cube::Cube;
use crate::deposit::Deposit;
use crate::lookup::{Lookup, PIXELS_A_TASK};
use rayon::prelude::*;
use spectra_core::math::{exp, log10};
use std::f64::consts::LN_10;

/// Steps of the tables over the amounts of three dyes. Densities of sums over the band are nearly linear in the amounts: their
/// second derivative is the variance of the dye's density over what the receiver sees, times ln 10, 0.2 or less. Over a
/// range of 4 that is 0.2 / 8 * (4 / 64)^2 = 1e-4 in density.
const STEPS: usize = 64;

/// Steps of the table over the amounts of a print: light follows them without a steep curve between, and what lies beyond the
/// screen's gamut is brought back by differences of it. Within 0.6 of a code value of 8 bits, where 64 are within 1.6.
const PRINT_STEPS: usize = 96;

/// Steps of the picture of one layer of silver, and the largest density there. The picture's second derivative over
/// density is below 60, so linear interpolation is within 60 / 8 * (6 / 8192)^2 = 4e-6.
const SILVER_STEPS: usize = 8192;
const HIGHEST_DENSITY: f64 = 6.0;

/// How far beyond the curves' amounts the tables go: grain does.
const MARGIN: f64 = 0.15;

/// Largest density of XYZ and its steps: 10^-D is interpolated within 2.3^2 / 8 * (12 / 65536)^2 = 2e-8 of D = 0.
const DENSITY_STEPS: usize = 1 << 16;
const DARKEST: f64 = 12.0;

#[derive(Clone, Debug)]
pub(super) enum Tables {
    /// One layer: what each density is shown as.
    Silver(Vec<[f32; 3]>),
    /// Three layers.
    Dyes(Box<Dyes>),
}

#[derive(Clone, Debug)]
pub(super) struct Dyes {
    /// Amounts of the film to densities of XYZ, of the scanner's channels, or of what exposes the print's layers.
    first: Cube,
    /// Log10 exposure to amounts of the print's layers; none where nothing is printed.
    curves: Vec<Lookup>,
    /// Amounts of a print of three dyes to densities of XYZ.
    last: Option<Cube>,
    /// Densities of XYZ of the bare light.
    bare: [f32; 3],
    /// Light over density.
    light: Lookup,
}

impl Tables {
    pub(super) fn new(film: &Deposit, ranges: &[(f64, f64)], way: &Way) -> Self {
        if film.layers() == 1 {
            return Self::silver(film, way, Reach::Screen);
        }
        let ranges = [0, 1, 2].map(|i| (ranges[i].0 - MARGIN, ranges[i].1 + MARGIN));
        let (weights, printing) = match way {
            Way::Look(viewing) => (viewing.weights(), None),
            Way::Scan(scan) => (&scan.weights[..], None),
            Way::Print(printing) => (&printing.weights[..], Some(printing)),
        };
        let mut curves = Vec::new();
        let mut last = None;
        if let Some(printing) = printing {
            let print = &printing.emulsion;
            let layers = print.layers();
            // Print curves bend within hundredths of a decade.
            let curve = |i: usize| Lookup::new(-6.0, 6.0, 24_000, |x| print.amount(i, x));
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
        let light = Lookup::new(-1.0, DARKEST, DENSITY_STEPS, |d| exp(-LN_10 * d));
        Self::Dyes(Box::new(Dyes { first: densities(film, ranges, weights, STEPS), curves, last, bare, light }))
    }

    /// Those of one layer of silver.
    pub(super) fn silver(film: &Deposit, way: &Way, reach: Reach) -> Self {
        Self::Silver(silver(film, way, reach))
    }

    /// The picture; that of silver goes as far as its table was made for.
    pub(super) fn picture(&self, planes: &[&[f32]], way: &Way, reach: Reach) -> Vec<[f32; 3]> {
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
                let pixels = a.par_iter().zip(b.par_iter()).zip(c.par_iter()).with_min_len(PIXELS_A_TASK);
                pixels.map(|((a, b), c)| dyes.shown([*a, *b, *c], way, reach)).collect()
            }
            // Planes are as many as layers: the film that made the one made the other.
            _ => Vec::new(),
        }
    }
}

impl Dyes {
    fn shown(&self, amounts: [f32; 3], way: &Way, reach: Reach) -> [f32; 3] {
        let first = self.first.at(amounts);
        let (densities, viewing) = match way {
            Way::Look(viewing) => (first, viewing),
            Way::Scan(scan) => return scan.shown_in(&first.map(f64::from), reach).map(|v| v as f32),
            Way::Print(printing) => {
                let mut amounts = [0.0_f32; 3];
                for ((amount, curve), d) in amounts.iter_mut().zip(&self.curves).zip(first) {
                    *amount = curve.at(-f64::from(d)) as f32;
                }
                let densities = match &self.last {
                    Some(last) => last.at(amounts),
                    // Silver: the same in X, Y and Z.
                    None => [amounts[0] + self.bare[0], amounts[0] + self.bare[1], amounts[0] + self.bare[2]],
                };
                (densities, &printing.viewing)
            }
        };
        let [x, y, z] = densities;
        let light = |d: f32| self.light.at(f64::from(d));
        let [r, g, b] = viewing.shown_in([light(x), light(y), light(z)], reach);
        [r as f32, g as f32, b as f32]
    }
}

fn silver(film: &Deposit, way: &Way, reach: Reach) -> Vec<[f32; 3]> {
    let one = |i: usize| {
        let amounts = [i as f64 / SILVER_STEPS as f64 * HIGHEST_DENSITY];
        let shown = match way {
            Way::Look(viewing) => viewing.shown_in(viewing.xyz(film, &amounts), reach),
            Way::Print(printing) => printing.viewing.shown_in(printing.xyz(film, &amounts), reach),
            Way::Scan(scan) => scan.shown_in(&scan.densities(film, &amounts), reach),
        };
        shown.map(|v| v as f32)
    };
    (0..SILVER_STEPS + 1).into_par_iter().with_min_len(256).map(one).collect()
}

/// Densities that three receivers see of each place of three dyes.
pub(super) fn seen(film: &Deposit, ranges: &[(f64, f64)], weights: &[Vec<f64>], planes: [&[f32]; 3]) -> Vec<[f32; 3]> {
    let ranges = [0, 1, 2].map(|i| (ranges[i].0 - MARGIN, ranges[i].1 + MARGIN));
    let cube = densities(film, ranges, weights, STEPS);
    let [a, b, c] = planes;
    let pixels = a.par_iter().zip(b.par_iter()).zip(c.par_iter()).with_min_len(PIXELS_A_TASK);
    pixels.map(|((a, b), c)| cube.at([*a, *b, *c])).collect()
}

/// Densities that up to three receivers see, over the amounts of three dyes.
fn densities(deposit: &Deposit, ranges: [(f64, f64); 3], weights: &[Vec<f64>], steps: usize) -> Cube {
    let place = |k: usize, i: usize| ranges[k].0 + (ranges[k].1 - ranges[k].0) * i as f64 / steps as f64;
    let layers: Vec<Vec<Vec<f64>>> =
        (0..3).map(|k| (0..=steps).map(|i| deposit.layer_transmittance(k, place(k, i))).collect()).collect();
    let base = deposit.base_transmittance();
    Cube::by_slabs(ranges, steps, |i, to| {
        for (j, row) in to.chunks_mut(steps + 1).enumerate() {
            let both: Vec<f64> =
                base.iter().zip(&layers[0][i]).zip(&layers[1][j]).map(|((b, x), y)| b * x * y).collect();
            for (channel, weight) in weights.iter().take(3).enumerate() {
                // Where the receiver sees nothing there is nothing to add.
                let from = weight.iter().position(|w| *w != 0.0).unwrap_or(0);
                let to = weight.iter().rposition(|w| *w != 0.0).map_or(0, |last| last + 1).max(from);
                let weighed: Vec<f64> = both[from..to].iter().zip(&weight[from..to]).map(|(b, w)| b * w).collect();
                for (value, third) in row.iter_mut().zip(&layers[2]) {
                    value[channel] = -log10(dot(&weighed, &third[from..to])) as f32;
                }
            }
        }
    })
}

/// Sum of products, in four interleaved sums: always the same order, and not one addition waiting for the last.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    for (a, b) in a.chunks(4).zip(b.chunks(4)) {
        a.iter().zip(b).zip(&mut sums).for_each(|((a, b), s)| *s += a * b);
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}
