//! Weights the noise of each block of the frame for sharing out the rays.
//!
//! Rays in proportion to the root mean square make the sum of the blocks' noise as small as possible. A block that light reaches through a
//! small part of the front may then be left with many times the noise of the others, because it is one of thousands. Such a block gets more
//! weight here, until its noise is at most [`LIMIT`] times the mean. The weights are Lagrange multipliers of an upper limit for each block,
//! found by iterations, each of which shares the rays out again.

use super::tree::Tree;

/// Upper limit on the variance of a block, relative to the mean of all judged blocks. The low-discrepancy numbers of a picture leave less
/// in most blocks, but not in those that few rays reach.
const LIMIT: f64 = 1.25;
/// Number of rays at which the uncertainty of the noise is as large as the noise itself.
const FEW: f64 = 200.0;
/// Number of iterations; each leaves about the square root of an excess.
const TURNS: usize = 12;

/// A path: its cells for each zone of the source, the index of its first cell among those of all paths, and the cost of a ray.
pub(super) struct PathCells<'a> {
    pub zones: &'a [Tree],
    pub first: usize,
    pub cost: f64,
}

/// The contribution of a cell to a block: an estimate of the integral over the cell of the squared contribution, relative to the square of
/// the block's light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// Index of the cell, counted through all paths.
    pub cell: usize,
    pub block: usize,
    pub square: f64,
}

/// Finds the best ray density for given squares. Returns for each cell of a path the ray density, with mean 1 in its zone, and the variance
/// of one ray.
pub(super) fn best(zones: &[Tree], squares: &[f64]) -> (Vec<Vec<f64>>, f64) {
    let (mut all, mut variance, mut first) = (Vec::with_capacity(zones.len()), 0.0, 0);
    for tree in zones {
        let own = &squares[first..first + tree.leaves()];
        first += tree.leaves();
        let mut dense = tree.best(own);
        let sum: f64 = dense.iter().zip(tree.areas()).map(|(dense, area)| dense * area).sum();
        if sum > 0.0 {
            dense.iter_mut().for_each(|dense| *dense /= sum);
            variance += own.iter().zip(&dense).map(|(square, dense)| square / dense).sum::<f64>();
        }
        all.push(dense);
    }
    (all, variance)
}

/// Computes the weight of the noise of each block. `rays` is the effective number of rays that the noise is known from; `None` for a block
/// too dim to be judged separately, which weighs 1.
pub(super) fn weights(pieces: &[Piece], paths: &[PathCells], rays: &[Option<f64>]) -> Vec<f64> {
    // The noise from few rays is uncertain, and is most likely higher.
    let doubts: Vec<f64> = rays.iter().map(|rays| rays.map_or(1.0, |rays| 1.0 + FEW / rays.max(1.0))).collect();
    let judged = rays.iter().flatten().count().max(1) as f64;
    let cells = paths.last().map_or(0, |path| path.first + path.zones.iter().map(Tree::leaves).sum::<usize>());
    let mut weights = vec![1.0_f64; rays.len()];
    for _ in 0..TURNS {
        let mut squares = vec![0.0; cells];
        pieces.iter().for_each(|p| squares[p.cell] += weights[p.block] * p.square);
        // Rays per unit area, scaled so that their total cost is 1.
        let (mut dense, mut cost) = (Vec::with_capacity(cells), 0.0);
        for path in paths {
            let (zones, variance) = best(path.zones, &squares[path.first..]);
            let rays = (variance / path.cost).sqrt();
            cost += rays * path.cost;
            dense.extend(zones.into_iter().flatten().map(|dense| dense * rays));
        }
        let mut noise = vec![0.0; rays.len()];
        let seen = pieces.iter().filter(|p| p.square > 0.0);
        seen.for_each(|p| noise[p.block] += doubts[p.block] * p.square * cost / dense[p.cell]);
        let of_judged = noise.iter().zip(rays).filter(|(_, rays)| rays.is_some());
        let limit = LIMIT * of_judged.map(|(noise, _)| noise).sum::<f64>() / judged;
        if limit <= 0.0 {
            break;
        }
        for ((weight, noise), _) in weights.iter_mut().zip(&noise).zip(rays).filter(|(_, rays)| rays.is_some()) {
            *weight = (*weight * noise / limit).max(1.0);
        }
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each of 256 blocks has a cell, and one more block has a hundredth of the last cell. By the sum alone it would have ten times the
    /// noise of the others; with its weight it has the limit, and the others pay for it with a few percent.
    #[test]
    fn a_block_that_few_rays_reach_weighs_more() {
        // Cut four times: 256 cells.
        let places = (0..256 * 32).map(|i| [(i % 16) as f64 / 16.0, (i / 16 % 16) as f64 / 16.0]);
        let tree = Tree::around(places.collect());
        let many = 256;
        let mut pieces: Vec<Piece> = (0..many).map(|at| Piece { cell: at, block: at, square: 1.0 }).collect();
        pieces[many - 1].square = 0.99;
        // Relative to its light, which is a hundredth.
        pieces.push(Piece { cell: many - 1, block: many, square: 0.01 / (0.01 * 0.01) });
        let rays = vec![Some(1e9); many + 1];
        let zones = [tree];
        let noise = |weights: &[f64]| -> Vec<f64> {
            let mut squares = vec![0.0; zones[0].leaves()];
            pieces.iter().for_each(|p| squares[p.cell] += weights[p.block] * p.square);
            let (dense, _) = best(&zones, &squares);
            let mut noise = vec![0.0; many + 1];
            pieces.iter().for_each(|p| noise[p.block] += p.square / dense[0][p.cell]);
            noise
        };
        let mean = |noise: &[f64]| noise.iter().sum::<f64>() / noise.len() as f64;
        let paths = [PathCells { zones: &zones, first: 0, cost: 12.0 }];
        let (before, after) = (noise(&vec![1.0; many + 1]), noise(&weights(&pieces, &paths, &rays)));
        assert!(before[many] > 5.0 * mean(&before), "{} {}", before[many], mean(&before));
        assert!(after[many] < 1.05 * LIMIT * mean(&after), "{} {}", after[many], mean(&after));
        assert!(after[0] < 1.5 * before[0], "{} {}", after[0], before[0]);
        // Blocks that no ray reached or that are not judged change nothing.
        assert_eq!(weights(&[], &paths, &[None, Some(5.0)]), [1.0, 1.0]);
    }
}
