//! Table of the coefficients of colors outside sRGB.
//!
//! Near the spectral locus only dark reflectances exist. The largest value to which a color is scaled therefore falls toward the boundary:
//! on the triangle of sRGB it is that of sRGB's table, on the boundary of [`RealGamut`] it is 0.005. The spectrum is scaled back. Spectra
//! thus change without a step where a picture's colors leave sRGB.
//!
//! The table has a column for each direction from white, and more columns where coefficients change quickly: neighboring columns are so
//! close that the color halfway between them is right to [`NEAR`].

use super::reflectance::Coefficients;
use super::solver::Solver;
use super::table::LEVEL;
use spectra_color::{RealGamut, RgbSpace};
use spectra_core::math::exp;
use std::sync::OnceLock;

/// Natural logarithm of the ratio of 0.005, the largest value to which a color on the boundary is scaled, to [`LEVEL`].
const FALL: f64 = -4.605_170_185_988_091;
/// Number of points in a column; they are closer together toward the boundary.
const ROWS: usize = 33;
/// Number of directions before refinement.
const DIRECTIONS: usize = 180;
/// Largest error of a color halfway between two directions: of each value, relative to the largest value, and of the luminance, relative to
/// itself.
const NEAR: f64 = 4e-3;
/// Directions that differ by less than this turn are not refined further, since the corners of the boundary are sharp.
const NARROWEST: f64 = 4e-4;
/// Largest distance of the solved color of a point from the wanted one, relative to the largest value.
const SOLVED: f64 = 1e-6;
/// Number of steps from gray to the triangle of sRGB.
const STEPS: usize = 12;

type Column = Vec<Coefficients>;

/// Table of coefficients over the direction and depth of a color, as defined by [`spectra_color::GamutPosition`].
pub(super) struct WideTable {
    real: RealGamut,
    points: Vec<Coefficients>,
}

impl WideTable {
    /// Returns the only table; the first call fills it.
    pub(super) fn get() -> &'static Self {
        static ONE: OnceLock<WideTable> = OnceLock::new();
        ONE.get_or_init(Self::new)
    }

    fn new() -> Self {
        let solver = Solver::new();
        let first = RealGamut::even(DIRECTIONS);
        let mut columns: Vec<(f64, Column)> = Vec::new();
        for turn in first.turns() {
            let column = (*turn, from_gray(&solver, *turn));
            if let Some(before) = columns.pop() {
                refine(&solver, before, &column, &mut columns);
            }
            columns.push(column);
        }
        let real = RealGamut::new(columns.iter().map(|(turn, _)| *turn));
        let points = columns.iter().flat_map(|(_, column)| column.iter().copied()).collect();
        Self { real, points }
    }

    /// Returns the scale and the coefficients of the spectrum of a color with a negative value; `None` if its luminance is not positive.
    pub(super) fn look_up(&self, linear_srgb: [f64; 3]) -> Option<(f64, Coefficients)> {
        let place = self.real.place(linear_srgb)?;
        let at = row_of(place.depth) * (ROWS - 1) as f64;
        let row = (at as usize).min(ROWS - 2);
        let weights = cubic(row, at - row as f64);
        let first = row.clamp(1, ROWS - 3) - 1;
        let mut mixed = [0.0; 3];
        for (column, share) in [1.0 - place.fraction, place.fraction].into_iter().enumerate() {
            let points = &self.points[(place.direction + column) * ROWS + first..][..4];
            for (point, weight) in points.iter().zip(weights) {
                for (sum, value) in mixed.iter_mut().zip(point) {
                    *sum += share * weight * value;
                }
            }
        }
        Some((place.peak / level(place.depth), mixed))
    }
}

/// Returns the Lagrange weights of the four points nearest to a place that lies the fraction `part` of the way from `row` to the next row.
fn cubic(row: usize, part: f64) -> [f64; 4] {
    let x = part + row as f64 - row.clamp(1, ROWS - 3) as f64;
    [
        -x * (x - 1.0) * (x - 2.0) / 6.0,
        (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0,
        -(x + 1.0) * x * (x - 2.0) / 2.0,
        (x + 1.0) * x * (x - 1.0) / 6.0,
    ]
}

/// Returns the largest value to which a color at that depth is scaled.
fn level(depth: f64) -> f64 {
    LEVEL * exp(depth * depth * depth * FALL)
}

/// Returns the depth of a row, 0 to 1.
fn depth(row: usize) -> f64 {
    let left = 1.0 - row as f64 / (ROWS - 1) as f64;
    1.0 - left * left
}

/// Returns the row of a depth as a fraction of a column, 0 to 1; the inverse of [`depth`].
fn row_of(depth: f64) -> f64 {
    1.0 - (1.0 - depth).sqrt()
}

fn color(turn: f64, row: usize) -> [f64; 3] {
    RealGamut::color(turn, depth(row)).map(|v| v * level(depth(row)))
}

/// Solves a column; each point starts from those before it.
fn from_gray(solver: &Solver, turn: f64) -> Column {
    let border = color(turn, 0);
    let mut found = [0.0; 3];
    for step in 1..STEPS {
        let share = step as f64 / STEPS as f64;
        found = solver.solve(border.map(|v| LEVEL + share * (v - LEVEL)), found, SOLVED * LEVEL);
    }
    let mut column: Column = Vec::with_capacity(ROWS);
    for row in 0..ROWS {
        // Starts from the linear extrapolation of the last two points.
        let start = match column[..] {
            [.., a, b] => [0, 1, 2].map(|k| 2.0 * b[k] - a[k]),
            _ => found,
        };
        found = solver.solve(color(turn, row), start, SOLVED * level(depth(row)));
        column.push(found);
    }
    column
}

/// Appends `before` and as many columns between it and `behind` as accuracy needs.
fn refine(solver: &Solver, before: (f64, Column), behind: &(f64, Column), to: &mut Vec<(f64, Column)>) {
    let turn = 0.5 * (before.0 + behind.0);
    let mut is_near = true;
    let mut column = Vec::with_capacity(ROWS);
    for (row, (a, b)) in before.1.iter().zip(&behind.1).enumerate() {
        let (between, wanted) = ([0, 1, 2].map(|k| 0.5 * (a[k] + b[k])), color(turn, row));
        let (got, _) = solver.color(between);
        let luminance = |rgb| RgbSpace::srgb().luminance(rgb);
        is_near &= got.iter().zip(wanted).all(|(a, b)| (a - b).abs() <= NEAR * level(depth(row)));
        is_near &= (luminance(got) / luminance(wanted) - 1.0).abs() <= NEAR;
        column.push(solver.solve(wanted, between, SOLVED * level(depth(row))));
    }
    let middle = (turn, column);
    if is_near || behind.0 - before.0 < NARROWEST {
        to.push(before);
    } else {
        refine(solver, before, &middle, to);
        refine(solver, middle, behind, to);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Newton's method reaches every point of the table, up to the boundary.
    #[test]
    fn every_color_is_solved() {
        let start = std::time::Instant::now();
        let (solver, table) = (Solver::new(), WideTable::new());
        println!("{} columns in {:?}", table.real.turns().len(), start.elapsed());
        for (direction, turn) in table.real.turns().iter().enumerate() {
            for row in 0..ROWS {
                let found = table.points[direction * ROWS + row];
                let (got, _) = solver.color(found);
                let off = got.iter().zip(color(*turn, row)).fold(0.0_f64, |w, (a, b)| w.max((a - b).abs()));
                assert!(off < 2e-6 * level(depth(row)), "{turn} {row}: {off:e} {found:?}");
            }
        }
    }
}
