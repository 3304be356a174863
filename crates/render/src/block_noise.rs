//! Measures how noisy a picture is and where it is clean, from the difference between two parts of its light with independently scrambled
//! random numbers ([`crate::parts`]).
//!
//! Light that may land anywhere has two halves: the difference between them is twice the error of their mean, in each of the 256 pixels of a
//! block. Light of single pixels has a second sequence in every eighth pixel: the difference between the two sequences has twice the
//! variance of one. A block has 32 such pixels, which tell its noise to within an eighth. Its neighbors in the same square of 64 x 64
//! pixels are judged together with it, unless it differs from them by more than chance allows.
//!
//! Whether a tile of light of single pixels goes on depends on such light of its square alone. If its noise is small enough whatever other
//! light is added, it is small enough.
//!
//! Everything is computed from exact sums in a fixed order, so that every machine finds the same blocks clean.

use crate::blocks::Blocks;
use crate::light::Light;
use crate::noise::Noise;
use crate::parts::Role;
use crate::renderer::Renderer;
use crate::tolerance::Tolerance;
use crate::{RenderError, SingleThread, Workers};
use spectra_core::workers::map_pieces;
use std::convert::Infallible;

/// An estimator goes on in a block if it causes at least this fraction of the variance, divided by the number of estimators.
const OWN_PART: f64 = 0.5;
/// A block is judged by itself if its deviation differs from that of its neighborhood by this many standard errors. That of n differences
/// is 1 / sqrt(2 n).
const BY_ITSELF: f64 = 2.0;

/// Sums over one block of pixels in one channel.
#[derive(Clone, Debug, Default)]
struct Cell {
    /// Sum of all light over the pixels, and of the light of single pixels.
    sum: f64,
    local: f64,
    /// Number of pixels that any light reached, and of check pixels that light of single pixels reached. In a mosaic, pixels of other
    /// colors have none.
    lit: f64,
    lit_checks: f64,
    /// Sums of squared errors of the pixels, one for each kind of light: over all pixels for light in halves, over check pixels for light of
    /// single pixels.
    squares: Vec<f64>,
}

impl Cell {
    /// Returns the mean of all light over the lit pixels.
    fn mean(&self) -> f64 {
        over(self.sum, self.lit)
    }

    /// Returns the mean of the light of single pixels over the lit pixels.
    fn local_mean(&self) -> f64 {
        over(self.local, self.lit)
    }

    /// Returns the variance of a pixel that a kind of light causes.
    fn variance(&self, kind: usize, is_local: bool) -> f64 {
        over(self.squares[kind], if is_local { self.lit_checks } else { self.lit })
    }
}

/// Returns a sum divided by a number, 0 if the number is 0.
fn over(sum: f64, number: f64) -> f64 {
    if number > 0.0 { sum / number } else { 0.0 }
}

/// The noise of each block.
struct BlockNoise {
    blocks: Blocks,
    /// Noise, and the noise that is asked for, in the channel that is worst there.
    noise: Vec<f64>,
    asked: Vec<f64>,
    /// Whether a kind of light goes on in a block.
    goes_on: Vec<Vec<bool>>,
    /// Whether what is asked for follows from the grain of a film.
    by_grain: bool,
}

impl Renderer {
    /// Measures the noise of all blocks.
    fn judge(&self, light: &Light, workers: &dyn Workers) -> Result<BlockNoise, RenderError> {
        let blocks = Blocks::of(self.scene().imager.size());
        let kinds = self.parts().kinds;
        let is_local: Vec<bool> = self.parts().all[kinds..].iter().map(|part| part.role == Role::Check).collect();
        let cells = self.cells_of_blocks(light, &blocks, workers);
        let tolerances = self.tolerances(light)?;
        let count = blocks.count();
        let (mut noise, mut asked) = (vec![0.0_f64; count], vec![0.0_f64; count]);
        let mut excess = vec![0.0_f64; count];
        let mut goes_on = vec![vec![false; count]; kinds];
        let local_kinds = is_local.iter().filter(|is| **is).count() as f64;
        for (cells, tolerance) in cells.iter().zip(&tolerances) {
            let tolerance = tolerance.with_floor(|| median(cells.iter().map(Cell::mean)));
            let variances = |cell: &Cell| -> Vec<f64> {
                is_local.iter().enumerate().map(|(kind, is_local)| cell.variance(kind, *is_local)).collect()
            };
            let of = |local: bool, variances: &[f64]| -> f64 {
                variances.iter().zip(&is_local).filter(|(_, is)| **is == local).map(|(v, _)| v).sum()
            };
            let allowed = |mean: f64| tolerance.deviation(mean).powi(2);
            let is_all = kinds as f64 == local_kinds;
            let allowed_local =
                |mean: f64| if is_all { allowed(mean) } else { tolerance.deviation_of_part(mean).powi(2) };
            // Variance of the light of single pixels, as a multiple of what is allowed.
            let local: Vec<f64> =
                cells.iter().map(|cell| over(of(true, &variances(cell)), allowed_local(cell.local_mean()))).collect();
            for (block, cell) in cells.iter().enumerate() {
                let own = variances(cell);
                let (local, checks) = pooled(
                    (local[block], cell.lit_checks),
                    blocks.around(block).map(|at| (local[at], cells[at].lit_checks)),
                );
                let all = of(false, &own) + local * allowed_local(cell.local_mean());
                let times = over(all, allowed(cell.mean())).sqrt();
                if times > excess[block] {
                    let mean = cell.mean().max(tolerance.floor());
                    (excess[block], noise[block], asked[block]) =
                        (times, all.sqrt() / mean, tolerance.deviation(cell.mean()) / mean);
                }
                for kind in 0..kinds {
                    let (goes, least) = if is_local[kind] {
                        (local * sure(checks) > 1.0, OWN_PART / local_kinds * of(true, &own))
                    } else {
                        (times > 1.0, OWN_PART / kinds as f64 * all)
                    };
                    goes_on[kind][block] |= goes && own[kind] >= least;
                }
            }
        }
        let by_grain = tolerances.iter().any(Tolerance::is_grain);
        Ok(BlockNoise { blocks, noise, asked, goes_on, by_grain })
    }

    /// Sums the light of each block in each judged channel.
    fn cells_of_blocks(&self, light: &Light, blocks: &Blocks, workers: &dyn Workers) -> Vec<Vec<Cell>> {
        let (parts, kinds) = (self.parts(), self.parts().kinds);
        let time_s = self.scene().exposure_time_s();
        let weights: Vec<Vec<f64>> = parts
            .estimators()
            .zip(&light.parts)
            .map(|(estimator, part)| estimator.weights(&[&part.done], part.rays, time_s))
            .collect();
        let (channels, judged) = (self.recorded().len(), self.judged_channels());
        let cell = |block: usize, channel: usize| {
            let mut cell = Cell { squares: vec![0.0; kinds], ..Cell::default() };
            for pixel in blocks.pixels(block) {
                let (mut sum, mut local, mut is_check) = (0.0, 0.0, false);
                let value = |at: usize| {
                    let place = parts.place(&parts.all[at], pixel)?;
                    Some(light.parts[at].sums.get(place * channels + channel) as f64 * weights[at][pixel])
                };
                for kind in 0..kinds {
                    let (Some(a), b) = (value(kind), value(kinds + kind)) else { continue };
                    match (parts.all[kinds + kind].role, b) {
                        (Role::Check, Some(b)) => {
                            // One sequence has half the variance of the difference.
                            cell.squares[kind] += 0.5 * (a - b) * (a - b);
                            (sum, local, is_check) = (sum + 0.5 * (a + b), local + 0.5 * (a + b), true);
                        }
                        (Role::Check, None) => (sum, local) = (sum + a, local + a),
                        (_, b) => {
                            // The error of the mean of two halves is half their difference.
                            let b = b.unwrap_or(a);
                            cell.squares[kind] += 0.25 * (a - b) * (a - b);
                            sum += 0.5 * (a + b);
                        }
                    }
                }
                cell.sum += sum;
                cell.local += local;
                cell.lit += f64::from(u8::from(sum != 0.0));
                cell.lit_checks += f64::from(u8::from(is_check && local != 0.0));
            }
            cell
        };
        // Work on one row of blocks at a time, channel by channel.
        let row = |(): &mut (), row: usize| -> Result<Vec<Vec<Cell>>, Infallible> {
            let of = |channel: &usize| (0..blocks.across).map(|c| cell(row * blocks.across + c, *channel)).collect();
            Ok(judged.iter().map(of).collect())
        };
        let Ok(rows) = map_pieces(workers, blocks.down, || (), row);
        (0..judged.len()).map(|channel| rows.iter().flat_map(|row| row[channel].clone()).collect()).collect()
    }

    /// Ends the tiles that are clean: they get no more samples. Must be called between rounds only.
    pub(crate) fn end_clean(&self, light: &mut Light, workers: &dyn Workers) -> Result<(), RenderError> {
        let BlockNoise { blocks, goes_on, .. } = self.judge(light, workers)?;
        let kinds = self.parts().kinds;
        for (kind, part) in self.parts().firsts().iter().enumerate() {
            let estimator = &part.estimator;
            let mut tiles = vec![false; estimator.tiles()];
            for block in (0..blocks.count()).filter(|block| goes_on[kind][*block]) {
                blocks.tiles(block).for_each(|pixel| tiles[estimator.tile_of(pixel)] = true);
            }
            for (tile, _) in tiles.iter().enumerate().filter(|(_, goes_on)| !**goes_on) {
                light.parts[kind].done.end_tile(tile as u32);
                light.parts[kinds + kind].done.end_tile(tile as u32);
            }
        }
        Ok(())
    }

    /// Returns the noise of the light so far; `None` if the scene asks for none, or if a part of the light has no ray yet.
    pub(crate) fn noise(&self, light: &Light) -> Result<Option<Noise>, RenderError> {
        if self.scene().render.noise.is_none() || light.parts.iter().any(|part| part.rays == 0) {
            return Ok(None);
        }
        let BlockNoise { mut noise, asked, by_grain, .. } = self.judge(light, &SingleThread)?;
        let clean = noise.iter().zip(&asked).filter(|(n, asked)| n <= asked).count() as f64 / noise.len() as f64;
        let asked = median(asked.into_iter().filter(|asked| *asked > 0.0));
        noise.sort_unstable_by(f64::total_cmp);
        let of = |part: f64| noise[((noise.len() - 1) as f64 * part) as usize];
        Ok(Some(Noise { asked, by_grain, median: of(0.5), p95: of(0.95), worst: of(1.0), clean }))
    }
}

/// Returns the mean variance of a block and its neighbors, or that of the block alone if it differs by more than chance. Each variance comes
/// with the number of check pixels that it was measured in.
fn pooled((alone, checks): (f64, f64), near: impl Iterator<Item = (f64, f64)>) -> (f64, f64) {
    let (sum, all) = near.fold((0.0, 0.0), |(sum, all), (own, checks)| (sum + own * checks, all + checks));
    let pooled = over(sum, all);
    let chance = 1.0 + BY_ITSELF / (2.0 * checks).sqrt();
    let ratio = over(alone, pooled).sqrt();
    if ratio > chance || ratio * chance < 1.0 { (alone, checks) } else { (pooled, all) }
}

/// Returns the factor by which a variance may be larger than was measured in this many check pixels: by one standard error of the deviation.
/// Without it, places would stop as soon as their noise looks too small by chance.
fn sure(checks: f64) -> f64 {
    let deviation = 1.0 + 1.0 / (2.0 * checks).sqrt();
    deviation * deviation
}

/// Returns the median of some values, 0 if there are none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut all: Vec<f64> = values.collect();
    let middle = all.len() / 2;
    if all.is_empty() { 0.0 } else { *all.select_nth_unstable_by(middle, f64::total_cmp).1 }
}
