//! A density over the unit square to draw places from, by the cells of a [`Tree`](super::tree::Tree).

/// How many places are drawn side by side.
pub(super) const ABREAST: usize = 8;

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

    /// [`Density::draw`] of several side by side: by itself each step waits for the cell that the one before it found.
    #[inline]
    pub fn draw_abreast(
        own: [&Self; ABREAST],
        mut u: [f64; ABREAST],
        mut v: [f64; ABREAST],
    ) -> [([f64; 2], f64); ABREAST] {
        let mut cells: [Cell; ABREAST] = std::array::from_fn(|k| own[k].cells[0]);
        let (mut low, mut side, mut density) = ([[0.0; 2]; ABREAST], [1.0; ABREAST], [1.0; ABREAST]);
        while cells.iter().any(|cell| cell.first != 0) {
            for k in 0..ABREAST {
                let cell = cells[k];
                // Who has arrived stays.
                let goes_on = cell.first != 0;
                let (mut across_it, mut along_it, smaller) = (u[k], v[k], 0.5 * side[k]);
                let (row, lengthwise) = half(&mut along_it, cell.lower);
                let (column, across) = half(&mut across_it, cell.left[row]);
                let corner = [low[k][0] + column as f64 * smaller, low[k][1] + row as f64 * smaller];
                let denser = density[k] * (4.0 * lengthwise * across);
                u[k] = if goes_on { across_it } else { u[k] };
                v[k] = if goes_on { along_it } else { v[k] };
                low[k] = if goes_on { corner } else { low[k] };
                side[k] = if goes_on { smaller } else { side[k] };
                density[k] = if goes_on { denser } else { density[k] };
                let next = if goes_on { cell.first as usize + 2 * row + column } else { 0 };
                cells[k] = if goes_on { own[k].cells[next] } else { cell };
            }
        }
        std::array::from_fn(|k| ([low[k][0] + u[k] * side[k], low[k][1] + v[k] * side[k]], density[k]))
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
    let is_upper = *number >= edge;
    // By bits, without a branch: nobody can guess where a random number lies.
    let upper = u64::from(is_upper).wrapping_neg();
    let length = f64::from_bits(edge.to_bits() & !upper | (1.0 - edge).to_bits() & upper);
    let from = f64::from_bits(edge.to_bits() & upper);
    *number = ((*number - from) / length).min(BELOW_ONE);
    (usize::from(is_upper), length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::numbers::Numbers;

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

    /// Bit for bit, of cells that lie one, two and no steps deep.
    #[test]
    fn side_by_side_they_are_as_one_by_one() {
        let deep = |first: f64| {
            let densities = [first, 0.3, 2.0, 0.1, 0.7, 0.0, 5.0, 1.0];
            let mut cells = vec![(1, 0.0), (5, 0.0)];
            cells.extend(densities.map(|density| (0, density)));
            cells.truncate(9);
            Density::of(&cells)
        };
        let (all, numbers) = ([deep(1.0), deep(0.2), Density::even()], Numbers::sobol(1));
        for i in 0..512 {
            let own: [&Density; ABREAST] = std::array::from_fn(|k| &all[(i as usize + k) % 3]);
            let of = |dimension: u32| std::array::from_fn(|k| numbers.one(k as u64, i, dimension));
            let (u, v): ([f64; ABREAST], [f64; ABREAST]) = (of(0), of(1));
            let want: [_; ABREAST] = std::array::from_fn(|k| own[k].draw(u[k], v[k]));
            assert_eq!(Density::draw_abreast(own, u, v), want);
        }
    }
}
