//! Divides the unit square into cells that are smaller where more rays came: each cell with many rays is cut into four.
//!
//! A dim block whose light enters in a small part of the area of bright blocks gets cells of its own this way, once a ray has found it. No
//! cell lies beside one of less than half its side, and none has less than a tenth of its neighbor's ray density. The edge of the light
//! that reaches a block is not where the last ray of the pilot went.

use super::density::{Density, Steps};

/// Number of rays above which a cell is cut.
const MANY: usize = 64;
/// Largest depth of cuts.
const DEEPEST: u32 = 12;
/// Lower limit on the mean square in a cell, as a fraction of that in the cell from which it was cut.
const LEAST: f64 = 1.0 / 64.0;
/// Lower limit on the ray density in a cell, as a fraction of that in its neighbors. The light does not end exactly where the last ray of
/// the pilot went.
const BESIDE: f64 = 0.1;
/// Number of cells over which this limit reaches.
const AROUND: usize = 2;

/// A cell of the tree, cut or not.
#[derive(Clone, Copy, Debug)]
struct Cell {
    /// Index of the first of the four parts: lower left, lower right, upper left, upper right. 0 if the cell is not cut.
    first: u32,
    /// Number of the cell among those that are not cut.
    leaf: u32,
    low: [f64; 2],
    side: f64,
}

/// The cells of the unit square, each listed after the cell that it is a part of.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    cells: Vec<Cell>,
    leaves: usize,
}

impl Tree {
    /// Builds cells around places where rays came through.
    pub fn around(mut places: Vec<[f64; 2]>) -> Self {
        let mut tree = Self { cells: vec![Cell { first: 0, leaf: 0, low: [0.0; 2], side: 1.0 }], leaves: 0 };
        tree.cut(0, &mut places, DEEPEST);
        tree.balance();
        for cell in tree.cells.iter_mut().filter(|cell| cell.first == 0) {
            cell.leaf = tree.leaves as u32;
            tree.leaves += 1;
        }
        tree
    }

    fn cut(&mut self, at: usize, places: &mut [[f64; 2]], cuts: u32) {
        if places.len() <= MANY || cuts == 0 {
            return;
        }
        let first = self.quarter(at);
        let middle = self.cells[first + 3].low;
        let (below, above) = parted(places, |p| p[1] < middle[1]);
        for (row, places) in [below, above].into_iter().enumerate() {
            let (left, right) = parted(places, |p| p[0] < middle[0]);
            for (column, places) in [left, right].into_iter().enumerate() {
                self.cut(first + 2 * row + column, places, cuts - 1);
            }
        }
    }

    /// Cuts a cell and returns the index of the first of its parts.
    fn quarter(&mut self, at: usize) -> usize {
        let (first, Cell { low: [x, y], side, .. }) = (self.cells.len(), self.cells[at]);
        self.cells[at].first = first as u32;
        let half = 0.5 * side;
        let corners = [[x, y], [x + half, y], [x, y + half], [x + half, y + half]];
        self.cells.extend(corners.map(|low| Cell { first: 0, leaf: 0, low, side: half }));
        first
    }

    /// Cuts cells until no cell has a neighbor with less than half its side.
    fn balance(&mut self) {
        let mut left: Vec<usize> = (0..self.cells.len()).collect();
        while let Some(at) = left.pop() {
            let Cell { first: 0, side, .. } = self.cells[at] else { continue };
            for place in around(&self.cells[at]) {
                let mut beside = self.find(place);
                while self.cells[beside].side > 2.5 * side {
                    let first = self.quarter(beside);
                    left.extend(first..first + 4);
                    beside = self.find(place);
                }
            }
        }
    }

    /// Returns the index of the uncut cell that holds a place.
    #[inline]
    fn find(&self, place: [f64; 2]) -> usize {
        let (mut at, mut steps) = (0, Steps::to(place));
        while self.cells[at].first != 0 {
            let [column, row] = steps.next();
            at = self.cells[at].first as usize + column + 2 * row;
        }
        at
    }

    /// Returns the number, among the uncut cells, of the cell that holds a place.
    #[inline]
    pub fn leaf(&self, place: [f64; 2]) -> usize {
        self.cells[self.find(place)].leaf as usize
    }

    /// Number of cells that are not cut.
    pub fn leaves(&self) -> usize {
        self.leaves
    }

    /// Iterates over the areas of the uncut cells.
    pub fn areas(&self) -> impl Iterator<Item = f64> {
        // Cells are numbered in this order.
        self.cells.iter().filter(|cell| cell.first == 0).map(|cell| cell.side * cell.side)
    }

    /// Returns the ray density of least variance in each uncut cell, up to a common factor. It is the root mean square
    /// contribution of the cell; `squares` holds the integral of the squared contribution over each cell.
    pub fn best(&self, squares: &[f64]) -> Vec<f64> {
        let of = |cell: &Cell| if cell.first == 0 { squares[cell.leaf as usize] } else { 0.0 };
        let mut means: Vec<f64> = self.cells.iter().map(of).collect();
        for at in (0..self.cells.len()).rev() {
            let Cell { first, side, .. } = self.cells[at];
            if first != 0 {
                means[at] = 0.25 * means[first as usize..][..4].iter().sum::<f64>();
            } else {
                means[at] /= side * side;
            }
        }
        let mut best = vec![0.0; self.leaves];
        for (at, cell) in self.cells.iter().enumerate() {
            if cell.first == 0 {
                best[cell.leaf as usize] = means[at].sqrt();
            } else {
                let least = LEAST * means[at];
                means[cell.first as usize..][..4].iter_mut().for_each(|mean| *mean = mean.max(least));
            }
        }
        best
    }

    /// Builds a density from the ray density in each uncut cell, up to a common factor. Low values are raised to the limit given by
    /// [`BESIDE`].
    pub fn density(&self, densities: &[f64]) -> Density {
        let mut soft = densities.to_vec();
        let beside = |cell: &Cell| around(cell).map(|place| self.leaf(place));
        let all = self.cells.iter().filter(|cell| cell.first == 0);
        let pairs: Vec<[usize; 2]> =
            all.flat_map(|cell| beside(cell).map(|other| [cell.leaf as usize, other])).collect();
        for _ in 0..AROUND {
            let before = soft.clone();
            for [a, b] in &pairs {
                soft[*a] = soft[*a].max(BESIDE * before[*b]);
                soft[*b] = soft[*b].max(BESIDE * before[*a]);
            }
        }
        let cell = |cell: &Cell| (cell.first, if cell.first == 0 { soft[cell.leaf as usize] } else { 0.0 });
        Density::of(&self.cells.iter().map(cell).collect::<Vec<_>>())
    }
}

/// Iterates over one place in each of the eight neighboring cells of the same size, as far as they lie in the unit square.
fn around(cell: &Cell) -> impl Iterator<Item = [f64; 2]> + use<> {
    let Cell { low: [x, y], side, .. } = *cell;
    let ways = (0..9).filter(|way| *way != 4).map(|way| [f64::from(way % 3), f64::from(way / 3)]);
    let places = ways.map(move |[right, up]| [x + (right - 0.5) * side, y + (up - 0.5) * side]);
    places.filter(|place| place.iter().all(|at| (0.0..1.0).contains(at)))
}

/// Partitions places into those for which the condition is true and the others.
fn parted(places: &mut [[f64; 2]], is_first: impl Fn(&[f64; 2]) -> bool) -> (&mut [[f64; 2]], &mut [[f64; 2]]) {
    let mut end = 0;
    for at in 0..places.len() {
        if is_first(&places[at]) {
            places.swap(at, end);
            end += 1;
        }
    }
    places.split_at_mut(end)
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::numbers::Numbers;

    /// Places drawn from cells of all sizes have the density that the tree reports, and reach all of the square.
    #[test]
    fn places_have_their_density() {
        let numbers = Numbers::sobol(3);
        let place = |i: u64| [numbers.one(1, i, 0), numbers.one(1, i, 1)];
        let corner = |i: u64| place(i).map(|x| x * x * x);
        let tree = Tree::around((0..8192).map(corner).collect());
        assert!(tree.leaves() > 200, "{}", tree.leaves());
        assert!((tree.areas().sum::<f64>() - 1.0).abs() < 1e-12);
        let squares: Vec<f64> = (0..tree.leaves()).map(|leaf| f64::from(leaf % 7 == 3)).collect();
        let tree = tree.density(&tree.best(&squares));
        let (n, mut area, mut sum) = (1 << 16, 0.0, 0.0);
        for i in 0..n {
            let (at, density) = tree.draw(numbers.one(2, i, 3), numbers.one(2, i, 4));
            assert!((tree.at(at) / density - 1.0).abs() < 1e-12);
            area += 1.0 / density / n as f64;
            sum += at[0] * at[1] / density / n as f64;
        }
        assert!((area - 1.0).abs() < 0.01, "{area}");
        assert!((sum - 0.25).abs() < 0.004, "{sum}");
    }
}
