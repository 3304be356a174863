//! Standard normal numbers on a lattice at all scales.

use spectra_core::numbers::{GOLDEN, mix64};
use spectra_numerics::normal;

/// The coarsest level: one of its cells is as wide as 2^24 cells of the finest level.
pub(super) const TOP: u32 = 24;

/// Size of the table of normal numbers: 12 bits.
const NORMALS: usize = 4096;

/// A standard normal number for every cell of every level.
///
/// The cell (i, j) of a level covers the cells (2i, 2j) to (2i + 1, 2j + 1) of the level below; its number is half their sum. Cells of one
/// level are independent.
pub(super) struct Field {
    key: u64,
    normals: Vec<f32>,
}

/// A rectangle of cells with their numbers.
#[derive(Default)]
pub(super) struct Cells {
    x: i64,
    y: i64,
    width: usize,
    height: usize,
    values: Vec<f32>,
    parents: Vec<f32>,
}

impl Cells {
    /// Returns the cells of the row `y` from the column `x` on.
    #[inline(always)]
    pub(super) fn row(&self, y: i64, x: i64) -> &[f32] {
        let row = (y - self.y) as usize;
        &self.values[row * self.width..(row + 1) * self.width][(x - self.x) as usize..]
    }
}

impl Field {
    pub(super) fn new(seed: u64, layer: u32) -> Self {
        let key = mix64(mix64(seed.wrapping_add(GOLDEN)) ^ (u64::from(layer) + 1).wrapping_mul(GOLDEN));
        // Quantiles at the centers of equal steps, scaled to a variance of 1.
        let quantiles: Vec<f64> = (0..NORMALS).map(|k| normal::quantile((k as f64 + 0.5) / NORMALS as f64)).collect();
        let variance = quantiles.iter().map(|q| q * q).sum::<f64>() / NORMALS as f64;
        let normals = quantiles.iter().map(|q| (q / variance.sqrt()) as f32).collect();
        Self { key, normals }
    }

    #[inline(always)]
    fn row_key(&self, level: u32, j: i64) -> u64 {
        mix64(self.key ^ mix64((j as u64).wrapping_mul(GOLDEN).wrapping_add(u64::from(level) << 56)))
    }

    /// Fills `cells` with at least the `size[0]` by `size[1]` cells of `level` from the cell `from` on.
    #[inline(always)]
    pub(super) fn fill(&self, level: u32, from: [i64; 2], size: [usize; 2], cells: &mut Cells) {
        let last = [from[0] + size[0] as i64 - 1, from[1] + size[1] as i64 - 1];
        let begin = |axis: usize, l: u32| from[axis] >> (l - level);
        let count = |axis: usize, l: u32| ((last[axis] >> (l - level)) - begin(axis, l) + 1) as usize;
        (cells.x, cells.y, cells.width, cells.height) = (begin(0, TOP), begin(1, TOP), count(0, TOP), count(1, TOP));
        cells.values.clear();
        for j in 0..cells.height as i64 {
            let key = self.row_key(TOP + 1, cells.y + j);
            for i in 0..cells.width as i64 {
                let bits = mix64(key.wrapping_add(((cells.x + i) as u64).wrapping_mul(GOLDEN)));
                cells.values.push(self.normals[(bits as usize) % NORMALS]);
            }
        }
        for l in (level..TOP).rev() {
            // Only the needed cells of the level above are split.
            let (x, y, width, height) = (begin(0, l + 1), begin(1, l + 1), count(0, l + 1), count(1, l + 1));
            std::mem::swap(&mut cells.values, &mut cells.parents);
            cells.values.resize(4 * width * height, 0.0);
            for j in 0..height {
                let key = self.row_key(l, y + j as i64);
                let row = ((y - cells.y) as usize + j) * cells.width + (x - cells.x) as usize;
                let parents = &cells.parents[row..][..width];
                let (upper, lower) = cells.values[4 * j * width..4 * (j + 1) * width].split_at_mut(2 * width);
                self.split(key, x, parents, upper, lower);
            }
            (cells.x, cells.y, cells.width, cells.height) = (2 * x, 2 * y, 2 * width, 2 * height);
        }
    }

    /// Splits a row of cells into two rows of quarters. Multiplies the four numbers of a cell (its own and three drawn) by the Hadamard
    /// matrix of order 4, halved, which keeps them independent with variance 1.
    #[inline(always)]
    fn split(&self, key: u64, x: i64, parents: &[f32], upper: &mut [f32], lower: &mut [f32]) {
        let normals: &[f32; NORMALS] = self.normals.as_slice().try_into().expect("the table has its size");
        let mut counter = key.wrapping_add((x as u64).wrapping_mul(GOLDEN));
        for ((z, upper), lower) in parents.iter().zip(upper.chunks_exact_mut(2)).zip(lower.chunks_exact_mut(2)) {
            let bits = mix64(counter);
            counter = counter.wrapping_add(GOLDEN);
            let a = normals[(bits >> 52) as usize % NORMALS];
            let b = normals[(bits >> 40) as usize % NORMALS];
            let c = normals[(bits >> 28) as usize % NORMALS];
            upper[0] = 0.5 * ((z + a) + (b + c));
            upper[1] = 0.5 * ((z + a) - (b + c));
            lower[0] = 0.5 * ((z - a) + (b - c));
            lower[1] = 0.5 * ((z - a) - (b - c));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_cut_gives_the_same_cells() {
        let field = Field::new(5, 2);
        let (mut whole, mut part) = (Cells::default(), Cells::default());
        field.fill(3, [-70, -5], [150, 40], &mut whole);
        field.fill(3, [-13, 11], [33, 7], &mut part);
        for y in 11..18 {
            assert_eq!(part.row(y, -13)[..33], whole.row(y, -13)[..33]);
        }
    }

    #[test]
    fn coarse_cells_are_half_the_sum_of_their_quarters() {
        let field = Field::new(1, 0);
        let (mut fine, mut coarse) = (Cells::default(), Cells::default());
        field.fill(2, [-64, 0], [128, 64], &mut fine);
        field.fill(4, [-16, 0], [32, 16], &mut coarse);
        for j in 0..16 {
            for i in 0..32 {
                let mut sum = 0.0;
                for y in 0..4 {
                    sum += fine.row(4 * j + y, 4 * (i as i64 - 16))[..4].iter().sum::<f32>();
                }
                assert!((coarse.row(j, -16)[i] - sum / 4.0).abs() < 1e-5);
            }
        }
    }

    /// Checks mean, variance, fourth moment, and the absence of correlation with neighbors, rows, levels, layers or seeds: within 4
    /// standard errors (4.5 where many are checked).
    #[test]
    fn cells_are_independent_normals() {
        let side = 512;
        let n = (side * side) as f64;
        let take = |seed, layer, level| {
            let mut cells = Cells::default();
            Field::new(seed, layer).fill(level, [1000, 2000], [side, side], &mut cells);
            (0..side).flat_map(|y| cells.row(2000 + y as i64, 1000)[..side].to_vec()).collect::<Vec<f32>>()
        };
        let a = take(1, 0, 0);
        let moment = |p: i32| a.iter().map(|z| f64::from(*z).powi(p)).sum::<f64>() / n;
        assert!(moment(1).abs() < 4.0 / n.sqrt(), "{}", moment(1));
        assert!((moment(2) - 1.0).abs() < 4.0 * (2.0 / n).sqrt(), "{}", moment(2));
        assert!(moment(3).abs() < 4.0 * (15.0 / n).sqrt(), "{}", moment(3));
        assert!((moment(4) - 3.0).abs() < 4.0 * (96.0 / n).sqrt(), "{}", moment(4));
        let with = |b: &[f32]| a.iter().zip(b).map(|(x, y)| f64::from(x * y)).sum::<f64>() / n;
        for other in [take(1, 1, 0), take(2, 0, 0), take(1, 0, 1), take(1, 0, 5)] {
            assert!(with(&other).abs() < 4.0 / n.sqrt(), "{}", with(&other));
        }
        for y in 0..9 {
            for x in 0..9 {
                if x + y > 0 {
                    let mut sum = 0.0;
                    for row in 0..side - y {
                        for column in 0..side - x {
                            sum += f64::from(a[row * side + column] * a[(row + y) * side + column + x]);
                        }
                    }
                    let pairs = ((side - x) * (side - y)) as f64;
                    assert!((sum / pairs).abs() < 4.5 / pairs.sqrt(), "lag {x} {y}: {}", sum / pairs);
                }
            }
        }
    }
}
