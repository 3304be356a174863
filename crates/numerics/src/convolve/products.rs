//! Convolution with a sum of separable kernels, each with the same profile across and down, as Gaussians have.
//!
//! Sums of light that is nowhere negative lose nothing to rounding. Single precision is therefore enough, and a bright point
//! leaves the shadows around it as they are. Work grows with the reach of the profiles; that of a transform does not.

use crate::isa::{Isa, Vectorized};
use rayon::prelude::*;

/// Rows and columns of the tiles that are worked on at once, together with the reach around them.
const ROWS: usize = 64;
const COLUMNS: usize = 512;

/// Number of columns that are summed at once.
const LANES: usize = 32;

/// A sum of separable kernels, prepared for the convolution of planes of one size.
pub struct Products {
    width: usize,
    height: usize,
    radius: usize,
    terms: Vec<Term>,
    isa: Isa,
}

/// One separable kernel, as weights from the middle on.
struct Term {
    down: Vec<f32>,
    /// Profile across, times the term's weight.
    across: Vec<f32>,
}

impl Products {
    /// Prepares `terms` for planes of `width` by `height` pixels. Each term is a weight and a profile: the values from the middle
    /// outward, the same across and down. A profile is cut off where its weight times the rest of the profile is less than
    /// `beyond`.
    ///
    /// # Panics
    /// If a profile is empty.
    pub fn new(terms: &[(f64, Vec<f64>)], beyond: f64, width: usize, height: usize) -> Self {
        let term = |(weight, profile): &(f64, Vec<f64>)| {
            let mut left = 0.0;
            let ends = profile.iter().rev().take_while(|v| {
                left += 2.0 * weight * **v;
                left < beyond
            });
            let profile = &profile[..(profile.len() - ends.count()).max(1)];
            let down = profile.iter().map(|v| *v as f32).collect();
            Term { down, across: profile.iter().map(|v| (v * weight) as f32).collect() }
        };
        let terms: Vec<Term> = terms.iter().map(term).collect();
        // The terms that stay in their pixel are merged into one.
        let (points, mut terms): (Vec<Term>, Vec<Term>) = terms.into_iter().partition(|t| t.down.len() == 1);
        if !points.is_empty() {
            let all = points.iter().map(|t| t.down[0] * t.across[0]).sum();
            terms.push(Term { down: vec![1.0], across: vec![all] });
        }
        let radius = terms.iter().map(|t| t.down.len() - 1).max().unwrap_or(0);
        Self { width, height, radius, terms, isa: Isa::detect() }
    }

    /// Number of multiplications for each pixel. A weight counts once for the two pixels at opposite offsets, which are added
    /// first.
    pub fn pairs(&self) -> usize {
        self.terms.iter().map(|t| 2 * t.down.len()).sum()
    }

    /// Convolves the plane `source`. For each pixel, `write` gets the element of `target` and the convolved value. Values outside
    /// the plane, and values that are not finite, count as 0.
    ///
    /// # Panics
    /// If the size of a plane differs from the one that was prepared for.
    pub fn apply(&self, source: &[f32], target: &mut [f32], write: impl Fn(&mut f32, f32) + Sync) {
        assert_eq!(source.len(), self.width * self.height, "the plane has the size that was prepared for");
        assert_eq!(target.len(), source.len(), "both planes have the same size");
        if source.is_empty() {
            return;
        }
        target.par_chunks_mut(self.width * ROWS).enumerate().for_each_init(
            || Scratch::new(self.radius),
            |scratch, (strip, target)| {
                let first = strip * ROWS;
                self.isa.run(Strip { products: self, source, first, target, scratch, write: &write });
            },
        );
    }
}

/// A tile with its surroundings, and one row of it.
struct Scratch {
    tile: Vec<f32>,
    stride: usize,
    line: Vec<f32>,
    sum: Vec<f32>,
}

impl Scratch {
    fn new(radius: usize) -> Self {
        let stride = COLUMNS + 2 * radius + LANES;
        Self {
            tile: vec![0.0; stride * (ROWS + 2 * radius)],
            stride,
            line: vec![0.0; stride + LANES],
            sum: vec![0.0; COLUMNS],
        }
    }

    /// Fills the tile with the surroundings of the pixel `x` in the row `y` of a plane.
    #[inline(always)]
    fn load(&mut self, plane: &[f32], [width, height]: [usize; 2], [x, y]: [usize; 2], rows: usize, radius: usize) {
        for (row, line) in self.tile.chunks_exact_mut(self.stride).take(rows + 2 * radius).enumerate() {
            let Some(row) = (y + row).checked_sub(radius).filter(|row| *row < height) else {
                line.fill(0.0);
                continue;
            };
            // Column c of the tile is x + c - radius.
            let first = radius.saturating_sub(x);
            let last = (width + radius - x).min(line.len());
            line[..first].fill(0.0);
            line[last..].fill(0.0);
            let from = row * width + x + first - radius;
            for (to, from) in line[first..last].iter_mut().zip(&plane[from..]) {
                *to = if from.is_finite() { *from } else { 0.0 };
            }
        }
    }
}

/// Some rows of a plane.
struct Strip<'a, F> {
    products: &'a Products,
    source: &'a [f32],
    first: usize,
    target: &'a mut [f32],
    scratch: &'a mut Scratch,
    write: &'a F,
}

/// Returns the weighted sum of [`LANES`] columns around a place. `far(k)` gives where the columns `k` before and `k` after it
/// begin. The smallest weights are added first.
#[inline(always)]
fn sum(weights: &[f32], values: &[f32], far: impl Fn(usize) -> (usize, usize)) -> [f32; LANES] {
    let mut sum = [0.0; LANES];
    for (k, weight) in weights.iter().enumerate().skip(1).rev() {
        let (before, after) = far(k);
        let (a, b) = (&values[before..before + LANES], &values[after..after + LANES]);
        for l in 0..LANES {
            sum[l] += weight * (a[l] + b[l]);
        }
    }
    let at = far(0).0;
    let middle = &values[at..at + LANES];
    for l in 0..LANES {
        sum[l] += weights[0] * middle[l];
    }
    sum
}

impl<F: Fn(&mut f32, f32)> Vectorized for Strip<'_, F> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { products, source, first, target, scratch, write } = self;
        let (width, radius) = (products.width, products.radius);
        let rows = target.len() / width;
        for x in (0..width).step_by(COLUMNS) {
            let columns = COLUMNS.min(width - x);
            scratch.load(source, [width, products.height], [x, first], rows, radius);
            let Scratch { tile, stride, line, sum: total } = &mut *scratch;
            for row in 0..rows {
                for (t, term) in products.terms.iter().enumerate() {
                    let reach = term.down.len() - 1;
                    for c in (0..columns + 2 * reach).step_by(LANES) {
                        let at = (row + radius) * *stride + radius - reach + c;
                        let down = sum(&term.down, tile, |k| (at - k * *stride, at + k * *stride));
                        line[c..c + LANES].copy_from_slice(&down);
                    }
                    for c in (0..columns).step_by(LANES) {
                        let across = sum(&term.across, line, |k| (c + reach - k, c + reach + k));
                        for (to, v) in total[c..c + LANES].iter_mut().zip(across) {
                            *to = if t == 0 { v } else { *to + v };
                        }
                    }
                }
                for (to, v) in target[row * width + x..][..columns].iter_mut().zip(total.iter()) {
                    write(to, *v);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Convolver, Kernel};
    use super::*;

    fn plane(width: usize, height: usize) -> Vec<f32> {
        (0..width * height).map(|k| ((k * 7919) % 1013) as f32 * if k % 97 == 5 { 1e4 } else { 0.01 }).collect()
    }

    fn terms(radius: usize) -> Vec<(f64, Vec<f64>)> {
        let falling = |by: f64| -> Vec<f64> { (0..=radius).map(|i| 0.5 / (1.0 + by * (i * i) as f64)).collect() };
        vec![(0.7, falling(3.0)), (0.3, falling(0.2))]
    }

    /// Against blocks of transforms, on planes smaller and larger than a tile, and thin ones.
    #[test]
    fn products_give_what_transforms_do() {
        for (width, height, radius) in [(1, 1, 0), (5, 3, 4), (40, 90, 9), (700, 70, 20), (3, 1100, 3), (1030, 129, 33)]
        {
            let (mut source, terms) = (plane(width, height), terms(radius));
            source[width / 2] = f32::NAN;
            let kernel = Kernel::new(radius, |i, j| terms.iter().map(|(w, p)| w * p[i] * p[j]).sum());
            let (mut target, mut wanted) = (vec![0.0; source.len()], vec![0.0; source.len()]);
            Products::new(&terms, 0.0, width, height).apply(&source, &mut target, |to, v| *to = v);
            Convolver::<f64>::new(&kernel, width, height).apply(&source, &mut wanted, |to, v| *to = v as f32);
            for (got, want) in target.iter().zip(&wanted) {
                assert!((got - want).abs() <= 2e-6 * want, "{width} {height} {radius}: {got} {want}");
            }
        }
    }

    #[test]
    fn same_bits_on_any_threads_and_tier() {
        let (width, height) = (900, 700);
        let source = plane(width, height);
        let run = |threads: usize, isa: Isa| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let mut products = Products::new(&terms(30), 0.0, width, height);
            products.isa = isa;
            let mut target = vec![0.0; source.len()];
            pool.install(|| products.apply(&source, &mut target, |to, v| *to = v));
            target
        };
        let want = run(1, Isa::Baseline);
        for isa in Isa::available() {
            assert!(run(3, isa) == want, "{}", isa.name());
        }
    }

    /// The part that is cut off a profile is less than the stated limit.
    #[test]
    fn profiles_end_where_nothing_is_left() {
        let profile = vec![0.5, 0.2, 0.04, 0.009, 0.001];
        for (beyond, pairs) in [(0.0, 10), (0.003, 8), (0.021, 6), (0.2, 4), (9.0, 2)] {
            assert_eq!(Products::new(&[(1.0, profile.clone())], beyond, 5, 5).pairs(), pairs, "{beyond}");
        }
    }
}
