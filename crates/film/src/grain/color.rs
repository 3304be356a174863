//! Granularity of color film: derives the granularity of each layer from microdensitometer readings through filters.

use crate::emulsion::Emulsion;
use crate::stock::Stock;
use spectra_core::math::log10;
use spectra_numerics::linear;

/// Amount of fog dye that is assumed in unexposed film (reversal: in fully exposed film), in the unit of dye amounts. It makes
/// such film grainy.
pub const FOG: f64 = 0.1;

/// Number of neutral exposures that are sampled.
const STEPS: usize = 120;

/// Smallest fraction of the variance that a filter reads which its own layer has. If the figures of the sheet are inconsistent, other
/// layers would otherwise take more than all of it.
const LEAST: f64 = 0.1;

/// Granularity of the layers of a color film.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorGrain {
    /// Points of each layer: the amount of dye above that of unexposed (reversal: fully exposed) film, in ascending order, and
    /// 1000 times its standard deviation through 48 um.
    layers: Vec<Vec<[f64; 2]>>,
}

impl ColorGrain {
    /// Computes the granularity of a stock with three layers that all have granularity over density; `None` for others.
    ///
    /// Each filter sees all three dyes, more or less. Through it the variances of the layers add up, each multiplied by the squared effect
    /// of a unit of its dye on the density. The sheet's readings of neutral film are separated accordingly.
    #[must_use]
    pub fn new(stock: &Stock, emulsion: &Emulsion) -> Option<Self> {
        if stock.layers.iter().any(|l| l.granularity.len() < 2) || stock.layers.len() != 3 {
            return None;
        }
        let names: Vec<&str> = stock.layers.iter().map(|l| l.name.as_str()).collect();
        let products = stock.densitometry.products(&names)?;
        let deposit = emulsion.deposit();
        let seen = |amounts: &[f64]| -> Vec<f64> {
            deposit.receiver_sums(amounts, &products).into_iter().map(|v| -log10(v)).collect()
        };
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

    /// Returns 1000 times the standard deviation of a layer through 48 um at an amount of dye, including [`FOG`].
    #[must_use]
    pub fn rms(&self, layer: usize, amount: f64) -> f64 {
        // Below the fog there is only a part of it.
        let part = (amount / FOG).clamp(0.0, 1.0).sqrt();
        part * between(&self.layers[layer], amount - FOG)
    }

    /// Returns the largest amount of dye in a layer for which the granularity is known, including [`FOG`].
    #[must_use]
    pub fn most(&self, layer: usize) -> f64 {
        self.layers[layer].last().map_or(FOG, |p| p[0] + FOG)
    }
}

/// Interpolates linearly between points; constant beyond the ends.
fn between(points: &[[f64; 2]], x: f64) -> f64 {
    let above = points.partition_point(|p| p[0] <= x);
    match (above.checked_sub(1).map(|i| points[i]), points.get(above)) {
        (Some(a), Some(b)) => a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]),
        (Some(a), None) => a[1],
        (None, Some(b)) => b[1],
        (None, None) => 0.0,
    }
}
