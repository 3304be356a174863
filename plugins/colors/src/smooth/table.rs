//! Table of the coefficients of colors inside sRGB.

use super::reflectance::Coefficients;
use super::solver::Solver;
use std::sync::OnceLock;

/// Largest value to which colors are scaled before they are looked up.
pub(super) const LEVEL: f64 = 0.5;
/// Points along each side of the table.
pub(super) const SIDE: usize = 65;

/// Coefficients for each of the three channels that can be largest, over the values of the next two channels relative to it.
pub(super) struct Table {
    pub(super) points: Vec<[f32; 3]>,
}

impl Table {
    /// Returns the table of sRGB; the first call fills it.
    pub(super) fn of_srgb() -> &'static Self {
        static ONE: OnceLock<Table> = OnceLock::new();
        ONE.get_or_init(|| {
            let solver = Solver::new();
            let mut points = Vec::with_capacity(3 * SIDE * SIDE);
            for largest in 0..3 {
                // Starting from gray, where all coefficients are 0, each point starts from a neighbor that is already solved.
                let mut rows = vec![[[0.0; 3]; SIDE]; SIDE];
                for row in (0..SIDE).rev() {
                    for column in (0..SIDE).rev() {
                        let mut color = [LEVEL; 3];
                        color[(largest + 1) % 3] = LEVEL * value(row);
                        color[(largest + 2) % 3] = LEVEL * value(column);
                        let start = match (row + 1 < SIDE, column + 1 < SIDE) {
                            (_, true) => rows[row][column + 1],
                            (true, false) => rows[row + 1][column],
                            (false, false) => [0.0; 3],
                        };
                        rows[row][column] = solver.solve(color, start, 1e-12);
                    }
                }
                points.extend(rows.iter().flatten().map(|c| c.map(|v| v as f32)));
            }
            Self { points }
        })
    }

    /// Returns the scale and the coefficients of the spectrum of a color, interpolated linearly between points. Negative values and NaN
    /// count as 0.
    pub(super) fn look_up(&self, linear_srgb: [f64; 3]) -> (f64, Coefficients) {
        let rgb = linear_srgb.map(|v| v.max(0.0));
        let largest = if rgb[0] >= rgb[1] && rgb[0] >= rgb[2] {
            0
        } else if rgb[1] >= rgb[2] {
            1
        } else {
            2
        };
        let most = rgb[largest];
        if most <= 0.0 {
            return (0.0, [0.0; 3]);
        }
        let cell = |v: f64| {
            let p = position(v / most);
            let i = (p as usize).min(SIDE - 2);
            // Weights are linear in the values themselves, not in the curved scale of the points.
            let (low, high) = (value(i), value(i + 1));
            (i, ((v / most - low) / (high - low)).clamp(0.0, 1.0))
        };
        let (row, along_rows) = cell(rgb[(largest + 1) % 3]);
        let (column, along_columns) = cell(rgb[(largest + 2) % 3]);
        let at = |r: usize, c: usize| self.points[(largest * SIDE + row + r) * SIDE + column + c].map(f64::from);
        let [p00, p01, p10, p11] = [at(0, 0), at(0, 1), at(1, 0), at(1, 1)];
        let mixed = |k: usize| mix([p00[k], p01[k], p10[k], p11[k]], along_rows, along_columns);
        (most / LEVEL, [mixed(0), mixed(1), mixed(2)])
    }
}

/// Returns the relative value at point `i` of a side, 0 to 1. Points are closer together toward 0, where a screen shows smaller
/// differences.
pub(super) fn value(i: usize) -> f64 {
    let s = i as f64 / (SIDE - 1) as f64;
    s * s
}

/// Returns the position on a side, in points, of a relative value; the inverse of [`value`].
#[inline(always)]
fn position(value: f64) -> f64 {
    (if value < 1.0 { value } else { 1.0 }).sqrt() * (SIDE - 1) as f64
}

/// Returns the cell of a value relative to the largest one, and the position of the value in that cell, 0 to 1. For black it is the first
/// cell.
#[inline(always)]
pub(super) fn cell(value_of: f64, most: f64) -> (u32, f64) {
    let relative = value_of / if most > 0.0 { most } else { 1.0 };
    let position = position(relative);
    // A cast to an integer would not be vectorized. Adding 2^52 leaves room for whole numbers only, which are then in the last bits.
    const WHOLE: f64 = (1_u64 << 52) as f64;
    let most = (SIDE - 2) as f64;
    let position = if position < most { position } else { most };
    let nearest = (position + WHOLE) - WHOLE;
    let below = if nearest > position { nearest - 1.0 } else { nearest };
    let i = (below + WHOLE).to_bits() as u32;
    // Weights are linear in the values themselves, not in the curved scale of the points.
    let curve = |at: f64| (at / (SIDE - 1) as f64) * (at / (SIDE - 1) as f64);
    let (low, high) = (curve(below), curve(below + 1.0));
    let part = (relative - low) / (high - low);
    let part = if part > 0.0 { part } else { 0.0 };
    (i, if part < 1.0 { part } else { 1.0 })
}

/// Interpolates linearly between four points.
#[inline(always)]
pub(super) fn mix([p00, p01, p10, p11]: [f64; 4], along_rows: f64, along_columns: f64) -> f64 {
    let upper = p00 + (p01 - p00) * along_columns;
    let lower = p10 + (p11 - p10) * along_columns;
    upper + (lower - upper) * along_rows
}
