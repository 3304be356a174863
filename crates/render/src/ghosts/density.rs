//! A probability density over the unit square from which places are drawn, given by the cells of a [`Tree`](super::tree::Tree).

/// Number of places that are drawn side by side.
pub(super) const ABREAST: usize = 16;
/// One number for each place drawn side by side.
pub(super) type Each = [f64; ABREAST];

/// The largest number below 1.
const BELOW_ONE: f64 = 1.0 - 0.5 * f64::EPSILON;

/// A cell. The cells of a path are read for some rays and then not for a while, so they are small: four fit into a cache line.
#[derive(Clone, Copy, Debug)]
struct Cell {
    /// Index of the first of the four parts: lower left, lower right, upper left, upper right. 0 if the cell is not cut.
    first: u32,
    /// Fraction of the cell's rays that goes to the lower half, and within each half to the left.
    lower: f32,
    left: [f32; 2],
}

/// A density over the unit square, with mean 1.
#[derive(Clone, Debug)]
pub(super) struct Density {
    cells: Vec<Cell>,
}

impl Density {
    /// Creates a uniform density.
    pub fn even() -> Self {
        Self { cells: vec![Cell { first: 0, lower: 0.5, left: [0.5; 2] }] }
    }

    /// Builds a density from cells, each listed after the cell that it is a part of. A cell is given by the index of the first of
    /// its four parts, or 0 if it is not cut, and by its ray density. Ray densities are read only for uncut cells, and are known
    /// up to a common factor.
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

    /// Draws a place by two numbers in [0, 1). Neighboring numbers give neighboring places, so strata survive. Returns the place and the
    /// ray density there.
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

    /// Draws several places side by side, like [`Density::draw`]. A single draw would wait at each step for the cell that the step before
    /// found. Each kind of work has its own loop, so that everything except reading the cells is vectorized. Writes the places over the
    /// numbers, and the ray densities.
    #[inline(always)]
    pub fn draw_abreast(own: [&Self; ABREAST], places: &mut [Each; 2], density: &mut Each) {
        let [x, y] = places;
        let (mut low_x, mut low_y, mut side) = ([0.0; ABREAST], [0.0; ABREAST], [1.0; ABREAST]);
        let mut at = [0_u32; ABREAST];
        *density = [1.0; ABREAST];
        loop {
            let (mut first, mut lower, mut left) = ([0_u32; ABREAST], [0.0_f32; ABREAST], [[0.0_f32; ABREAST]; 2]);
            let mut any = 0;
            for k in 0..ABREAST {
                let cell = &own[k].cells[at[k] as usize];
                (first[k], lower[k], left[0][k], left[1][k]) = (cell.first, cell.lower, cell.left[0], cell.left[1]);
                any |= cell.first;
            }
            if any == 0 {
                break;
            }
            for k in 0..ABREAST {
                // A draw that has arrived stays where it is.
                let goes_on = first[k] != 0;
                let (smaller, lower) = (0.5 * side[k], f64::from(lower[k]));
                let is_upper = y[k] >= lower;
                let (along, lengthwise) = within(y[k], lower, is_upper);
                let left = f64::from(if is_upper { left[1][k] } else { left[0][k] });
                let is_right = x[k] >= left;
                let (across, widthwise) = within(x[k], left, is_right);
                low_x[k] += if goes_on & is_right { smaller } else { 0.0 };
                low_y[k] += if goes_on & is_upper { smaller } else { 0.0 };
                x[k] = if goes_on { across } else { x[k] };
                y[k] = if goes_on { along } else { y[k] };
                side[k] = if goes_on { smaller } else { side[k] };
                density[k] *= if goes_on { 4.0 * lengthwise * widthwise } else { 1.0 };
                let part = 2 * u32::from(is_upper) + u32::from(is_right);
                at[k] = if goes_on { first[k] + part } else { at[k] };
            }
        }
        for k in 0..ABREAST {
            x[k] = low_x[k] + x[k] * side[k];
            y[k] = low_y[k] + y[k] * side[k];
        }
    }

    /// Returns the ray density at a place.
    #[inline]
    pub fn at(&self, place: [f64; 2]) -> f64 {
        let (mut cell, mut density, mut steps) = (&self.cells[0], 1.0, Steps::to(place));
        while cell.first != 0 {
            let [column, row] = steps.next();
            let of = |edge: f32, half: usize| [f64::from(edge), 1.0 - f64::from(edge)][half];
            density *= 4.0 * of(cell.lower, row) * of(cell.left[row], column);
            cell = &self.cells[cell.first as usize + 2 * row + column];
        }
        density
    }
}

/// The steps to a place of the unit square by repeated halving: its binary digits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps([u32; 2]);

impl Steps {
    #[inline]
    pub fn to(place: [f64; 2]) -> Self {
        Self(place.map(|number| (number * 4_294_967_296.0) as u32))
    }

    /// Returns the next step: 1 to the right or 0 to the left, and 1 up or 0 down.
    #[inline]
    pub fn next(&mut self) -> [usize; 2] {
        let step = self.0.map(|digits| (digits >> 31) as usize);
        self.0 = self.0.map(|digits| digits << 1);
        step
    }
}

/// Finds the part of the interval from 0 to 1 that holds a number: 0 below `edge`, or 1. Also returns the length of that part. The number
/// becomes the position within it.
#[inline]
fn half(number: &mut f64, edge: f32) -> (usize, f64) {
    let edge = f64::from(edge);
    let is_upper = *number >= edge;
    let (place, length) = within(*number, edge, is_upper);
    *number = place;
    (usize::from(is_upper), length)
}

/// Returns the position of a number in the upper or lower part of the interval from 0 to 1, and the length of that part.
#[inline(always)]
fn within(number: f64, edge: f64, is_upper: bool) -> (f64, f64) {
    let (from, length) = if is_upper { (edge, 1.0 - edge) } else { (0.0, edge) };
    let place = (number - from) / length;
    (if place < BELOW_ONE { place } else { BELOW_ONE }, length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::numbers::Numbers;

    /// No place is drawn where there are no rays, whatever the numbers.
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

    /// Draws side by side are the same as single ones, bit for bit, for cells one, two and no steps deep.
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
            let (mut places, mut density): ([Each; 2], Each) = ([of(0), of(1)], [0.0; ABREAST]);
            let want: [_; ABREAST] = std::array::from_fn(|k| own[k].draw(places[0][k], places[1][k]));
            Density::draw_abreast(own, &mut places, &mut density);
            assert_eq!(std::array::from_fn(|k| ([places[0][k], places[1][k]], density[k])), want);
        }
    }
}
