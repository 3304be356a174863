//! Where on the front of the lens the light of a path enters that comes to the frame.

/// Cells of a guide, across and up.
pub(super) const SIDE: usize = 24;
const CELLS: usize = SIDE * SIDE;
/// This part of the rays goes all over the front, whatever was found: so the estimate has no bias, and what was overlooked weighs
/// ten times as much at most.
const EVEN: f64 = 0.1;
/// A cell that nothing came through has at least this part of what its brightest neighbor has.
const BESIDE: f64 = 0.1;

/// A density over the square [-1, 1]^2 around the front disk: even over all of it, and by cells over a part of it.
#[derive(Clone, Debug)]
pub(super) struct Guide {
    /// The part that is cut into cells: two corners.
    low: [f64; 2],
    high: [f64; 2],
    /// What of the rays goes all over the square.
    even: f64,
    /// Sums of the probabilities of the rows, and within each row of its cells.
    rows: [f64; SIDE + 1],
    columns: Vec<f64>,
}

/// A place, and how dense rays are there: 1 over the square's unit of area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Aim {
    pub place: [f64; 2],
    pub density: f64,
}

impl Guide {
    /// Even over all of the square.
    pub fn everywhere() -> Self {
        Self::cells([-1.0; 2], [1.0; 2], &[1.0; CELLS])
    }

    /// Nothing but the even part.
    fn blind() -> Self {
        Self { even: 1.0, ..Self::everywhere() }
    }

    /// With these weights of the cells of a part, row by row.
    fn cells(low: [f64; 2], high: [f64; 2], weights: &[f64; CELLS]) -> Self {
        let mut rows = [0.0; SIDE + 1];
        let mut columns = vec![0.0; SIDE * (SIDE + 1)];
        for (row, of_row) in weights.chunks_exact(SIDE).enumerate() {
            let sums = &mut columns[row * (SIDE + 1)..][..=SIDE];
            for (at, weight) in of_row.iter().enumerate() {
                sums[at + 1] = sums[at] + weight;
            }
            let sum = sums[SIDE];
            rows[row + 1] = rows[row] + sum;
            if sum > 0.0 {
                sums.iter_mut().for_each(|s| *s /= sum);
            }
        }
        let sum = rows[SIDE];
        rows.iter_mut().for_each(|s| *s /= sum);
        Self { low, high, even: EVEN, rows, columns }
    }

    /// Draws a place by two numbers in [0, 1).
    #[inline]
    pub fn draw(&self, u: f64, v: f64) -> Aim {
        let (place, cell) = if u < self.even {
            let place = [2.0 * (u / self.even) - 1.0, 2.0 * v - 1.0];
            (place, self.cell_of(place))
        } else {
            let (row, y) = invert(&self.rows, v);
            let sums = &self.columns[row * (SIDE + 1)..][..=SIDE];
            let (column, x) = invert(sums, (u - self.even) / (1.0 - self.even));
            let along = |axis: usize, at: f64| self.low[axis] + (self.high[axis] - self.low[axis]) * at / SIDE as f64;
            ([along(0, x), along(1, y)], Some((row, column)))
        };
        let area = (self.high[0] - self.low[0]) * (self.high[1] - self.low[1]) / CELLS as f64;
        let by_cells = cell.map_or(0.0, |(row, column)| {
            let sums = &self.columns[row * (SIDE + 1)..][..=SIDE];
            (self.rows[row + 1] - self.rows[row]) * (sums[column + 1] - sums[column]) / area
        });
        Aim { place, density: 0.25 * self.even + (1.0 - self.even) * by_cells }
    }

    /// Row and column of the cell that holds a place.
    fn cell_of(&self, place: [f64; 2]) -> Option<(usize, usize)> {
        let at = |axis: usize| (place[axis] - self.low[axis]) / (self.high[axis] - self.low[axis]) * SIDE as f64;
        let (x, y) = (at(0), at(1));
        let inside = x >= 0.0 && y >= 0.0 && x < SIDE as f64 && y < SIDE as f64;
        inside.then_some((y as usize, x as usize))
    }
}

/// The interval of rising sums from 0 to 1 that holds a number, and the place in it in intervals.
#[inline]
fn invert(sums: &[f64], u: f64) -> (usize, f64) {
    let last = sums.len() - 2;
    let mut at = sums.partition_point(|s| *s <= u).clamp(1, last + 1) - 1;
    // Rounding may lead past the last one that has any.
    while at > 0 && sums[at + 1] <= sums[at] {
        at -= 1;
    }
    let part = ((u - sums[at]) / (sums[at + 1] - sums[at])).clamp(0.0, 1.0);
    (at, at as f64 + part)
}

/// What came through each cell of a guide in a pilot run.
#[derive(Clone, Debug)]
pub(super) struct Found {
    low: [f64; 2],
    high: [f64; 2],
    /// Sums of squares over densities: what the variance is made of.
    squares: [f64; CELLS],
    /// Rays that came through.
    rays: u64,
}

impl Found {
    /// Nothing yet, in the cells of a guide.
    pub fn of(guide: &Guide) -> Self {
        Self { low: guide.low, high: guide.high, squares: [0.0; CELLS], rays: 0 }
    }

    /// A ray that came through `place`, drawn by `density`, and brought `value` times 1 / `density`.
    pub fn add(&mut self, guide: &Guide, aim: Aim, value: f64) {
        self.rays += 1;
        if let Some((row, column)) = guide.cell_of(aim.place) {
            self.squares[row * SIDE + column] += value * value / aim.density;
        }
    }

    /// Whether any light came.
    pub fn is_empty(&self) -> bool {
        self.squares.iter().all(|s| *s == 0.0)
    }

    /// The part of the cells that light came through and their neighbors, all alike.
    pub fn closer(&self) -> Guide {
        let lit = || (0..CELLS).filter(|at| self.squares[*at] > 0.0);
        if self.is_empty() {
            return Guide::everywhere();
        }
        let ends = |of: fn(usize) -> usize| {
            let first = lit().map(of).min().unwrap_or(0).saturating_sub(1);
            let last = lit().map(of).max().unwrap_or(0) + 2;
            [first, last.min(SIDE)]
        };
        let (columns, rows) = (ends(|at| at % SIDE), ends(|at| at / SIDE));
        let at = |axis: usize, k: usize| self.low[axis] + (self.high[axis] - self.low[axis]) * k as f64 / SIDE as f64;
        let (low, high) = ([at(0, columns[0]), at(1, rows[0])], [at(0, columns[1]), at(1, rows[1])]);
        Guide::cells(low, high, &[1.0; CELLS])
    }

    /// The guide that has the least variance, as far as was found: each cell's rays go by the root of the mean square; and that
    /// variance of one ray, in the unit of the squares. `rays` were drawn in all.
    pub fn guide(&self, rays: u64) -> (Guide, f64) {
        if self.is_empty() {
            return (Guide::blind(), 0.0);
        }
        // The integral of the square over a cell, times its area: even cells would have the density 1 / area.
        let area = (self.high[0] - self.low[0]) * (self.high[1] - self.low[1]) / CELLS as f64;
        let roots = self.squares.map(|s| (s / rays as f64 * area).sqrt());
        let mut weights = roots;
        for (at, weight) in weights.iter_mut().enumerate() {
            let (row, column) = (at / SIDE, at % SIDE);
            for r in row.saturating_sub(1)..=(row + 1).min(SIDE - 1) {
                for c in column.saturating_sub(1)..=(column + 1).min(SIDE - 1) {
                    *weight = weight.max(BESIDE * roots[r * SIDE + c]);
                }
            }
        }
        let sum: f64 = roots.iter().sum();
        (Guide::cells(self.low, self.high, &weights), sum * sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::math::sin_cos_turns;
    use spectra_core::numbers::Numbers;

    /// Of a density the mean of one over it is the area, and the mean of a function over it is the function's integral, however
    /// little of it the guide has found.
    #[test]
    fn a_guide_has_no_bias() {
        let disk = |[x, y]: [f64; 2]| f64::from((x - 0.3) * (x - 0.3) + (y + 0.2) * (y + 0.2) < 0.01);
        let mut guide = Guide::everywhere();
        let numbers = Numbers::sobol(5);
        let n = 1 << 14;
        for round in 0..4 {
            let mut found = Found::of(&guide);
            let (mut area, mut integral, mut square) = (0.0, 0.0, 0.0);
            for i in 0..n {
                let aim = guide.draw(numbers.one(round, i, 3), numbers.one(round, i, 4));
                let value = disk(aim.place);
                area += 1.0 / aim.density / n as f64;
                integral += value / aim.density / n as f64;
                square += value / aim.density / aim.density / n as f64;
                if value > 0.0 {
                    found.add(&guide, aim, value);
                }
            }
            let sigma = (square / n as f64).sqrt();
            let want = 0.01 * std::f64::consts::PI;
            assert!((area / 4.0 - 1.0).abs() < 0.02, "{round}: {area}");
            assert!((integral - want).abs() < 4.0 * sigma, "{round}: {integral} {want} {sigma}");
            if round == 3 {
                // Nearly all rays of the guided part come through.
                assert!(square < 1.6 * want * want, "{square}");
            }
            guide = if round < 2 { found.closer() } else { found.guide(n).0 };
        }
    }

    #[test]
    fn what_was_not_found_is_looked_for_everywhere() {
        let guide = Found::of(&Guide::everywhere()).guide(100).0;
        let (sin, _) = sin_cos_turns(0.1);
        let aim = guide.draw(0.5 * sin, 0.75);
        assert_eq!((aim.place, aim.density), ([sin - 1.0, 0.5], 0.25));
    }
}
