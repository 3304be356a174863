//! A density over the unit square to draw places from, by the cells of a [`Tree`](super::tree::Tree).

/// The largest number below 1.
const BELOW_ONE: f64 = 1.0 - 0.5 * f64::EPSILON;

/// A cell. Those of a path are read for some rays and then not for a while, so they are small: four to a line of the cache.
#[derive(Clone, Copy, Debug)]
struct Cell {
    /// The first of its four parts: lower left, lower right, upper left, upper right. 0 where it is not cut.
    first: u32,
    /// What of its rays goes to the lower half, and within each half to the left.
    lower: f32,
    left: [f32; 2],
}

/// A density over the unit square, 1 in the mean.
#[derive(Clone, Debug)]
pub(super) struct Density {
    cells: Vec<Cell>,
}

impl Density {
    pub fn even() -> Self {
        Self { cells: vec![Cell { first: 0, lower: 0.5, left: [0.5; 2] }] }
    }

    /// Of cells, each behind what it is a part of: the number of the first of its four parts, or 0; and how dense rays are in those that are
    /// not cut, but for a factor.
    pub fn of(cells: &[(u32, f64)]) -> Self {
        let mut own = vec![Cell { first: 0, lower: 0.5, left: [0.5; 2] }; cells.len()];
        let mut means: Vec<f64> = cells.iter().map(|(_, density)| *density).collect();
        for (at, (first, _)) in cells.iter().enumerate().rev().filter(|(_, (first, _))| *first != 0) {
            let [a, b, c, d] = std::array::from_fn(|part| means[*first as usize + part]);
            let share = |part: f64, other: f64| if part + other > 0.0 { (part / (part + other)) as f32 } else { 0.5 };
            means[at] = 0.25 * (a + b + c + d);
            own[at] = Cell { first: *first, lower: share(a + b, c + d), left: [share(a, b), share(c, d)] };
        }
        Self { cells: own }
    }

    /// Draws a place by two numbers in [0, 1): neighbors to neighbors, so strata survive. The place, and how dense rays are there.
    #[inline]
    pub fn draw(&self, mut u: f64, mut v: f64) -> ([f64; 2], f64) {
        let (mut cell, mut low, mut side, mut density) = (&self.cells[0], [0.0; 2], 1.0, 1.0);
        while cell.first != 0 {
            side *= 0.5;
            let (row, lengthwise) = half(&mut v, cell.lower);
            let (column, across) = half(&mut u, cell.left[row]);
            low = [low[0] + column as f64 * side, low[1] + row as f64 * side];
            density *= 4.0 * lengthwise * across;
            cell = &self.cells[cell.first as usize + 2 * row + column];
        }
        ([low[0] + u * side, low[1] + v * side], density)
    }

    /// How dense rays are at a place.
    #[inline]
    pub fn at(&self, [mut x, mut y]: [f64; 2]) -> f64 {
        let (mut cell, mut density) = (&self.cells[0], 1.0);
        while cell.first != 0 {
            let (row, _) = half(&mut y, 0.5);
            let (column, _) = half(&mut x, 0.5);
            let of = |edge: f32, half: usize| [f64::from(edge), 1.0 - f64::from(edge)][half];
            density *= 4.0 * of(cell.lower, row) * of(cell.left[row], column);
            cell = &self.cells[cell.first as usize + 2 * row + column];
        }
        density
    }
}

/// Which part of the interval from 0 to 1 holds a number, 0 below `edge` or 1, and how long that part is; the number becomes the place in it.
#[inline]
fn half(number: &mut f64, edge: f32) -> (usize, f64) {
    let edge = f64::from(edge);
    let half = usize::from(*number >= edge);
    // Without a branch: nobody can guess where a random number lies.
    let length = [edge, 1.0 - edge][half];
    *number = ((*number - [0.0, edge][half]) / length).min(BELOW_ONE);
    (half, length)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the numbers, no place is drawn where there are no rays.
    #[test]
    fn parts_without_rays_are_left_out() {
        let parts = |densities: [f64; 4]| {
            let mut cells = vec![(1, 0.0)];
            cells.extend(densities.map(|density| (0, density)));
            Density::of(&cells)
        };
        for full in 0..4 {
            let density = parts(std::array::from_fn(|part| f64::from(u8::from(part == full))));
            for u in [0.0, 0.5, BELOW_ONE] {
                for v in [0.0, 0.5, BELOW_ONE] {
                    let ([x, y], dense) = density.draw(u, v);
                    assert_eq!((usize::from(x >= 0.5) + 2 * usize::from(y >= 0.5), dense), (full, 4.0));
                    assert_eq!(density.at([x, y]), 4.0);
                }
            }
        }
        assert_eq!(parts([0.0; 4]).draw(0.25, 0.75), ([0.25, 0.75], 1.0));
    }
}
