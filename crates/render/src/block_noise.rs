//! Measures how noisy a picture is and where it is clean, from two halves of the samples with independently scrambled random numbers.
//!
//! The difference between the halves of a pixel is twice the error of their mean. Its mean square over the 256 pixels of a block is
//! therefore known to within about 4 %, whatever the light looks like. Everything is computed from exact sums in a fixed order, so that
//! every machine finds the same blocks clean.

use crate::estimator::Estimator;
use crate::light::{EstimatorSums, Light};
use crate::noise::Noise;
use crate::renderer::Renderer;
use crate::tiles::TILE;
use crate::{SingleThread, Workers};
use spectra_core::workers::map_pieces;
use spectra_scene::Scene;
use std::convert::Infallible;

/// Side of a block, pixels; it holds whole tiles.
const BLOCK: usize = 16;
const _: () = assert!(BLOCK.is_multiple_of(TILE as usize));
/// A block darker than this fraction of the frame's median block (four stops) is judged as if it were no darker.
const DARKEST: f64 = 1.0 / 16.0;
/// An estimator goes on in a block if it causes at least this fraction of the variance, divided by the number of estimators.
const OWN_PART: f64 = 0.5;

/// Sums over one block of pixels in one channel.
#[derive(Clone, Debug, Default)]
struct Cell {
    /// Sum of the two halves over the lit pixels.
    sum: f64,
    /// Number of pixels that any light reached. In a mosaic, pixels of other colors have none.
    lit: f64,
    /// Sums of squared differences between the halves, one for each estimator.
    squares: Vec<f64>,
}

impl Cell {
    /// Returns the mean of both halves over the lit pixels.
    fn mean(&self) -> f64 {
        if self.lit > 0.0 { 0.5 * self.sum / self.lit } else { 0.0 }
    }
}

/// The frame, divided into blocks.
struct Blocks {
    across: usize,
    down: usize,
    width: usize,
    height: usize,
}

impl Blocks {
    fn of(scene: &Scene) -> Self {
        let size = scene.imager.size();
        let (width, height) = (size.width_px as usize, size.height_px as usize);
        Self { across: width.div_ceil(BLOCK), down: height.div_ceil(BLOCK), width, height }
    }

    /// Iterates over the pixels of a block, row by row.
    fn pixels(&self, block: usize) -> impl Iterator<Item = usize> {
        self.each(block, 1)
    }

    /// Iterates over the first pixel of each tile of a block.
    fn tiles(&self, block: usize) -> impl Iterator<Item = usize> {
        self.each(block, TILE as usize)
    }

    /// Iterates over the first pixel of each square of this side in a block.
    fn each(&self, block: usize, side: usize) -> impl Iterator<Item = usize> {
        let (column, row) = (block % self.across * BLOCK, block / self.across * BLOCK);
        let columns = (column..self.width.min(column + BLOCK)).step_by(side);
        let (rows, width) = ((row..self.height.min(row + BLOCK)).step_by(side), self.width);
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }
}

/// The noise of each block.
struct BlockNoise {
    blocks: Blocks,
    /// Noise of each block, in the worst of the channels that count.
    noise: Vec<f64>,
    /// Fraction of each block's variance that each estimator causes, in the channel that is worst there.
    share: Vec<Vec<f64>>,
}

impl Renderer {
    /// Measures the noise of all blocks.
    fn judge(&self, light: &Light, workers: &dyn Workers) -> BlockNoise {
        let blocks = Blocks::of(self.scene());
        let kinds = light.parts.len() / 2;
        let (first, second) = light.parts.split_at(kinds);
        let estimators: Vec<&dyn Estimator> = self.estimators().take(kinds).collect();
        let weights = |parts: &[EstimatorSums]| -> Vec<Vec<f64>> {
            let of = |(e, part): (&&dyn Estimator, &EstimatorSums)| e.weights(&[&part.done], part.rays, 1.0);
            estimators.iter().zip(parts).map(of).collect()
        };
        let (of_first, of_second) = (weights(first), weights(second));
        let (channels, judged) = (self.recorded().len(), self.judged_channels());
        let cell = |block: usize, channel: usize| {
            let mut cell = Cell { squares: vec![0.0; kinds], ..Cell::default() };
            for pixel in blocks.pixels(block) {
                let (at, mut sum) = (pixel * channels + channel, 0.0);
                for kind in 0..kinds {
                    let a = first[kind].sums.get(at) as f64 * of_first[kind][pixel];
                    let b = second[kind].sums.get(at) as f64 * of_second[kind][pixel];
                    sum += a + b;
                    cell.squares[kind] += (a - b) * (a - b);
                }
                cell.sum += sum;
                cell.lit += f64::from(u8::from(sum != 0.0));
            }
            cell
        };
        // Work on one row of blocks at a time, channel by channel.
        let row = |(): &mut (), row: usize| -> Result<Vec<Vec<Cell>>, Infallible> {
            let of = |channel: &usize| (0..blocks.across).map(|c| cell(row * blocks.across + c, *channel)).collect();
            Ok(judged.iter().map(of).collect())
        };
        let Ok(rows) = map_pieces(workers, blocks.down, || (), row);
        let mut noise = vec![0.0_f64; blocks.across * blocks.down];
        let mut share = vec![vec![0.0_f64; noise.len()]; kinds];
        for channel in 0..judged.len() {
            let cells: Vec<&Cell> = rows.iter().flat_map(|row| &row[channel]).collect();
            // The median block sets the limit below which a block counts as dark.
            let mut means: Vec<f64> = cells.iter().map(|cell| cell.mean()).collect();
            let middle = means.len() / 2;
            let floor = DARKEST * *means.clone().select_nth_unstable_by(middle, f64::total_cmp).1;
            means.iter_mut().for_each(|mean| *mean = mean.max(floor));
            for (block, cell) in cells.iter().enumerate() {
                let square: f64 = cell.squares.iter().sum();
                if !(square > 0.0 && means[block] > 0.0) {
                    continue;
                }
                // The error of the mean of two halves is half their difference.
                let own = 0.5 * (square / cell.lit).sqrt() / means[block];
                if own > noise[block] {
                    noise[block] = own;
                    for (share, of_kind) in share.iter_mut().zip(&cell.squares) {
                        share[block] = of_kind / square;
                    }
                }
            }
        }
        BlockNoise { blocks, noise, share }
    }

    /// Ends the tiles that are clean: they get no more samples. Must be called between rounds only.
    pub(crate) fn end_clean(&self, light: &mut Light, asked: f64, workers: &dyn Workers) {
        let BlockNoise { blocks, noise, share } = self.judge(light, workers);
        let kinds = light.parts.len() / 2;
        let least = OWN_PART / kinds as f64;
        for (kind, estimator) in self.estimators().take(kinds).enumerate() {
            let mut goes_on = vec![false; estimator.tiles()];
            for block in (0..noise.len()).filter(|b| noise[*b] > asked && share[kind][*b] >= least) {
                blocks.tiles(block).for_each(|pixel| goes_on[estimator.tile_of(pixel)] = true);
            }
            for (tile, _) in goes_on.iter().enumerate().filter(|(_, goes_on)| !**goes_on) {
                light.parts[kind].done.end_tile(tile as u32);
                light.parts[kinds + kind].done.end_tile(tile as u32);
            }
        }
    }

    /// Returns the noise of the light so far; `None` if the scene asks for none, or if the light does not have two halves yet.
    pub(crate) fn noise(&self, light: &Light) -> Option<Noise> {
        let asked = self.scene().render.noise?;
        if light.parts.iter().any(|part| part.rays == 0) {
            return None;
        }
        let mut noise = self.judge(light, &SingleThread).noise;
        noise.sort_unstable_by(f64::total_cmp);
        let of = |part: f64| noise[((noise.len() - 1) as f64 * part) as usize];
        let clean = noise.iter().filter(|n| **n <= asked).count() as f64 / noise.len() as f64;
        Some(Noise { asked, median: of(0.5), p95: of(0.95), worst: of(1.0), clean })
    }
}
