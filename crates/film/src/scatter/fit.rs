//! From a response over frequency to weights of pixels.

use super::mtf::{Mtf, MtfError};
use crate::convolve::{Grid, Kernel};

/// The curve is followed up to this part of half a cycle a pixel.
const BAND: f64 = 0.8;

/// Projections at most on small grids and on large ones (there they are dear, and one is as a rule enough), and the
/// difference that ends them.
const ROUNDS: [usize; 2] = [200, 20];
const CLOSE_ENOUGH: f64 = 1e-3;

/// Pixels that a kernel reaches, at least and at most.
const REACH: (f64, f64) = (12.0, 500.0);

pub(super) struct Fit {
    pub(super) kernel: Kernel,
    pub(super) residual: f64,
}

/// The weights from 0 on, within the curve's reach, whose response is closest to it: projections onto both convex
/// sets in turn (D. C. Youla and H. Webb, "Image restoration by the method of convex projections", IEEE Trans. Medical
/// Imaging 1, 1982).
pub(super) fn fit(mtf: &Mtf, pitch_mm: f64) -> Result<Fit, MtfError> {
    let out_of_range = |range| MtfError::OutOfRange { what: "pitch", value: pitch_mm, range };
    if !(pitch_mm > 0.0 && pitch_mm.is_finite()) {
        return Err(out_of_range("more than 0 mm"));
    }
    let reach = (mtf.reach_mm() / pitch_mm).ceil().max(REACH.0);
    if reach > REACH.1 {
        return Err(out_of_range("at least a thousandth of the spread"));
    }
    let reach = reach as usize;
    let side = (4 * reach).next_power_of_two();
    let mut grid = Grid::new(side);
    let frequency = |i: usize, j: usize| ((i * i + j * j) as f64).sqrt() / side as f64; // cycles a pixel
    let target = Kernel::new(side / 2, |i, j| mtf.response(frequency(i, j) / pitch_mm));
    let within = |i: usize, j: usize| frequency(i, j) <= BAND / 2.0;
    let mut response = target.clone();
    let mut best: Option<Fit> = None;
    for _ in 0..ROUNDS[usize::from(side > 128)] {
        let weights = grid.transform(&response).scaled(1.0 / (side * side) as f64);
        let weights = Kernel::new(reach, |i, j| {
            let inside = i * i + j * j <= reach * reach;
            if inside { weights.weight(i, j).max(0.0) } else { 0.0 }
        });
        let now = grid.transform(&weights);
        let sum = now.weight(0, 0);
        let mut residual = 0.0_f64;
        for j in 0..side / 2 + 1 {
            for i in (0..j + 1).filter(|i| within(*i, j)) {
                residual = residual.max((now.weight(i, j) / sum - target.weight(i, j)).abs());
            }
        }
        response = Kernel::new(side / 2, |i, j| if within(i, j) { target.weight(i, j) } else { now.weight(i, j) });
        if best.as_ref().is_none_or(|b| residual < b.residual) {
            let exact = weights.sum();
            best = Some(Fit { kernel: weights.scaled(1.0 / exact), residual });
        }
        if residual < CLOSE_ENOUGH {
            break;
        }
    }
    best.ok_or_else(|| out_of_range("more than 0 mm"))
}
