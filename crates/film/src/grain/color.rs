//! Granularity of color film: from what a microdensitometer reads through a filter to what each layer does.

use crate::emulsion::Emulsion;
use crate::stock::Stock;
use spectra_core::math::log10;
use spectra_numerics::linear;

/// Amount of dye that is there where nothing was exposed, in clouds of its own: what makes unexposed film grainy.
pub const FOG: f64 = 0.1;

/// Neutral exposures that are looked at.
const STEPS: usize = 120;

/// A layer has at least this part of the variance that its filter reads: more than all would be left to the others where the
/// figures of the sheet do not agree.
const LEAST: f64 = 0.1;

/// What the layers of a color film are as grainy as.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorGrain {
    /// Of each layer: amount over that of unexposed (reversal: fully exposed) film, rising, and 1000 times its deviation
    /// through 48 um.
    layers: Vec<Vec<[f64; 2]>>,
}

impl ColorGrain {
    /// That of a stock whose layers all have a granularity over density; `None` of others.
    ///
    /// Each filter sees all three dyes, more or less: through it the variances of the layers add up, each times the square of
    /// what a unit of its dye does to the density. The sheet's readings, of neutral film, are taken apart by that.
    #[must_use]
    pub fn new(stock: &Stock, emulsion: &Emulsion) -> Option<Self> {
        if stock.layers.iter().any(|l| l.granularity.len() < 2) || stock.layers.len() != 3 {
            return None;
        }
        let names: Vec<&str> = stock.layers.iter().map(|l| l.name.as_str()).collect();
        let products = stock.densitometry.products(&names)?;
        let deposit = emulsion.deposit();
        let seen =
            |amounts: &[f64]| -> Vec<f64> { deposit.seen(amounts, &products).into_iter().map(|v| -log10(v)).collect() };
        let least: Vec<f64> = (0..3).map(|l| emulsion.range(l).0).collect();
        let clear = seen(&least);
        let mut layers = vec![Vec::new(); 3];
        for step in 0..=STEPS {
            let amounts = emulsion.neutral(-5.0 + 8.0 * step as f64 / STEPS as f64);
            let density = seen(&amounts);
            let mut squares = Vec::with_capacity(9);
            let mut read = Vec::with_capacity(3);
            for filter in 0..3 {
                for layer in 0..3 {
                    const SMALL: f64 = 1e-4;
                    let mut more = amounts.clone();
                    more[layer] += SMALL;
                    let slope = (seen(&more)[filter] - density[filter]) / SMALL;
                    squares.push(slope * slope);
                }
                let rms = between(&stock.layers[filter].granularity, density[filter] - clear[filter]);
                read.push(rms * rms);
            }
            let variances = linear::solve(&squares, &read)?;
            for layer in 0..3 {
                let alone = read[layer] / squares[4 * layer];
                let variance = variances[layer].max(LEAST * alone);
                layers[layer].push([amounts[layer] - least[layer], variance.sqrt()]);
            }
        }
        for points in &mut layers {
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            points.dedup_by(|a, b| a[0] - b[0] < 1e-6);
        }
        Some(Self { layers })
    }

    /// 1000 times the deviation of a layer through 48 um at an amount of dye, [`FOG`] included.
    #[must_use]
    pub fn rms(&self, layer: usize, amount: f64) -> f64 {
        // Below the fog there is only a part of it.
        let part = (amount / FOG).clamp(0.0, 1.0).sqrt();
        part * between(&self.layers[layer], amount - FOG)
    }

    /// The largest amount that is known of, [`FOG`] included.
    #[must_use]
    pub fn most(&self, layer: usize) -> f64 {
        self.layers[layer].last().map_or(FOG, |p| p[0] + FOG)
    }
}

/// Straight between points, held beyond.
fn between(points: &[[f64; 2]], x: f64) -> f64 {
    let above = points.partition_point(|p| p[0] <= x);
    match (above.checked_sub(1).map(|i| points[i]), points.get(above)) {
        (Some(a), Some(b)) => a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]),
        (Some(a), None) => a[1],
        (None, Some(b)) => b[1],
        (None, None) => 0.0,
    }
}
