//! Divides the page into cells, to find quickly which edges decide the transmittance at a point.

use crate::{Edge, Paint, settle};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Largest number of cells of a page.
const MAX_CELLS: usize = 1 << 20;
/// Largest number of entries of all cells together.
const MAX_MEMBERS: usize = 1 << 23;
/// Number of cells for each edge.
const CELLS_PER_EDGE: usize = 16;
/// Smallest number of cells, if memory allows.
const MIN_CELLS: usize = 64;

/// Division of the page into cells.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cut {
    /// Number of cells along x and y.
    counts: [usize; 2],
    /// Half of the width and height of the page, mm.
    half_mm: [f64; 2],
    /// Number of cells per mm along x and y.
    per_mm: [f64; 2],
}

impl Cut {
    /// Divides the page into about `cells` cells, nearly square.
    fn new(half_mm: [f64; 2], cells: usize) -> Self {
        let columns = (cells as f64 * half_mm[0] / half_mm[1]).sqrt().clamp(1.0, cells as f64) as usize;
        let counts = [columns, (cells / columns).max(1)];
        Self { counts, half_mm, per_mm: [0, 1].map(|k| counts[k] as f64 / (2.0 * half_mm[k])) }
    }

    /// Returns a division with a quarter of the cells.
    fn coarser(&self) -> Self {
        Self::new(self.half_mm, (self.counts[0] * self.counts[1] / 4).max(1))
    }

    fn is_whole(&self) -> bool {
        self.counts == [1, 1]
    }

    /// Returns the column (`k` = 0) or row (`k` = 1) of a coordinate (mm) on the page.
    fn index(&self, k: usize, at_mm: f64) -> usize {
        (((at_mm + self.half_mm[k]) * self.per_mm[k]).max(0.0) as usize).min(self.counts[k] - 1)
    }

    /// Estimates the number of cells that the edges run through.
    fn crossings(&self, edges: &[Edge]) -> f64 {
        let along = |k: usize, length: f64| (length * self.per_mm[k]).min(self.counts[k] as f64);
        let crossed = |e: &Edge| 1.0 + along(1, e.high - e.low) + along(0, (e.slope * (e.high - e.low)).abs());
        edges.iter().map(crossed).sum()
    }

    /// Returns heights (mm) between which all points of a row lie: a little more than the row, to allow for rounding.
    fn sides(&self, row: usize) -> [f64; 2] {
        let at = |rows: f64| rows / self.per_mm[1] - self.half_mm[1];
        [at(row as f64 - 1e-6), at(row as f64 + 1.0 + 1e-6)]
    }

    /// Returns the first and last column that an edge runs through between two heights. -1 and the number of columns mean left and right
    /// of the page.
    ///
    /// Rounding keeps the order of numbers, so no computed x of the edge lies on the wrong side of a column.
    fn columns(&self, edge: &Edge, [bottom, top]: [f64; 2]) -> [i64; 2] {
        let (from, to) = (edge.x_at(edge.low.max(bottom)), edge.x_at(edge.high.min(top)));
        let (columns, half) = (self.counts[0] as i64, self.half_mm[0]);
        if from.is_nan() || to.is_nan() {
            return [0, columns - 1]; // The edge is so flat that its slope is infinite.
        }
        let column = |x: f64| match x {
            x if x < -half => -1,
            x if x > half => columns,
            x => self.index(0, x) as i64,
        };
        [column(from.min(to)), column(from.max(to))]
    }
}

/// The page divided into cells. The edges to the right of a point decide which shapes cover it. A cell lists only the edges that run
/// through it. The effect of the others is constant over the cell, except for steps at the heights where edges to the right begin or end.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid {
    cut: Cut,
    /// Transmittance of the shapes below all members of each cell, row by row.
    below: Arc<[f64]>,
    /// Index of the first member of each cell, and the total number of members.
    starts: Arc<[u32]>,
    /// Edge numbers of all cells, in each cell in the order of the shapes.
    members: Arc<[u32]>,
    /// Edges of the drawing, followed by the steps.
    edges: Arc<[Edge]>,
}

impl Grid {
    /// Divides a page with these half sizes (mm) as finely as its edges need but within the memory limit.
    pub(crate) fn new(half_mm: [f64; 2], edges: &[Edge], paints: &[Paint]) -> Self {
        let mut cut = Cut::new(half_mm, (CELLS_PER_EDGE * edges.len()).clamp(MIN_CELLS, MAX_CELLS));
        while !cut.is_whole() && cut.crossings(edges) > MAX_MEMBERS as f64 {
            cut = cut.coarser();
        }
        loop {
            let most = if cut.is_whole() { usize::MAX } else { MAX_MEMBERS };
            if let Some(grid) = Builder::new(cut, edges, paints).build(most) {
                return grid;
            }
            cut = cut.coarser();
        }
    }

    /// Returns, for the cell of a point on the page, the transmittance below its members, and the members in the order of the shapes.
    pub(crate) fn at(&self, x_mm: f64, y_mm: f64) -> (f64, impl Iterator<Item = &Edge>) {
        let cell = self.cut.index(1, y_mm) * self.cut.counts[0] + self.cut.index(0, x_mm);
        let members = &self.members[self.starts[cell] as usize..self.starts[cell + 1] as usize];
        (self.below[cell], members.iter().map(|number| &self.edges[*number as usize]))
    }
}

#[cfg(test)]
impl Grid {
    /// Returns the memory that the grid takes.
    pub(crate) fn memory_bytes(&self) -> usize {
        size_of_val(&*self.below) + size_of_val(&*self.starts) + size_of_val(&*self.members) + size_of_val(&*self.edges)
    }
}

/// Builder of a grid.
struct Builder<'a> {
    paints: &'a [Paint],
    cut: Cut,
    below: Vec<f64>,
    starts: Vec<u32>,
    members: Vec<u32>,
    /// Given edges, followed by the steps.
    edges: Vec<Edge>,
    /// Numbers of the steps among the edges, by shape, height and turn.
    steps: BTreeMap<(u32, u64, i32), u32>,
}

/// Combined effect of the edges to the right of a cell, without those that cancel. Heights are stored as bits, to serve as keys.
#[derive(Default)]
struct Right {
    /// Winding number of each shape at the lower side of the row.
    winding: BTreeMap<u32, i32>,
    /// Change of the winding number by shape and height.
    steps: BTreeMap<(u32, u64), i32>,
}

impl<'a> Builder<'a> {
    fn new(cut: Cut, edges: &[Edge], paints: &'a [Paint]) -> Self {
        let (below, starts, members, steps) = (Vec::new(), vec![0], Vec::new(), BTreeMap::new());
        Self { paints, cut, below, starts, members, edges: edges.to_vec(), steps }
    }

    fn edge(&self, number: u32) -> &Edge {
        &self.edges[number as usize]
    }

    /// Builds the grid; `None` if the cells would have more than `most` members in all.
    fn build(mut self, most: usize) -> Option<Grid> {
        let half = self.cut.half_mm[1];
        let on_page = |(number, edge): (u32, &Edge)| (edge.high > -half && edge.low <= half).then_some(number);
        let mut waiting: Vec<u32> = (0_u32..).zip(&self.edges).filter_map(on_page).collect();
        waiting.sort_by(|a, b| self.edge(*b).low.total_cmp(&self.edge(*a).low));
        let mut active: Vec<u32> = Vec::new();
        for row in 0..self.cut.counts[1] {
            let [bottom, top] = self.cut.sides(row);
            while let Some(number) = waiting.pop_if(|number| self.edge(*number).low <= top) {
                active.push(number);
            }
            active.retain(|number| self.edge(*number).high > bottom);
            self.row([bottom, top], &active, most)?;
        }
        let Self { cut, below, starts, members, edges, .. } = self;
        Some(Grid { cut, below: below.into(), starts: starts.into(), members: members.into(), edges: edges.into() })
    }

    /// Adds a row of cells; `None` if there are more than `most` members in all.
    fn row(&mut self, sides: [f64; 2], active: &[u32], most: usize) -> Option<()> {
        let columns = self.cut.counts[0] as i64;
        // Edges by each column that they run through, and by their first column.
        let (mut through, mut first) = (Vec::new(), Vec::with_capacity(active.len()));
        for number in active {
            let [from, to] = self.cut.columns(self.edge(*number), sides);
            first.push((from, *number));
            through.extend((from.max(0)..=to.min(columns - 1)).map(|column| (column, *number)));
            if self.members.len() + through.len() > most {
                return None;
            }
        }
        through.sort_unstable();
        first.sort_unstable();
        // Cells are computed from right to left, since each has more edges to its right than the last; they are stored from left to right.
        let mut right = Right::default();
        let (mut found, mut cells) = (Vec::new(), Vec::with_capacity(columns as usize));
        for column in (0..columns).rev() {
            while let Some((_, number)) = first.pop_if(|(from, _)| *from > column) {
                right.add(self.edge(number), sides, self.cut.half_mm[1]);
            }
            let own = through.partition_point(|(at, _)| *at < column);
            let start = found.len();
            found.extend(through.drain(own..).map(|(_, number)| number));
            let below = self.complete(start, &right, &mut found);
            cells.push((below, start..found.len()));
            if self.members.len() + found.len() > most {
                return None;
            }
        }
        for (below, range) in cells.into_iter().rev() {
            self.below.push(below);
            self.members.extend_from_slice(&found[range]);
            self.starts.push(self.members.len() as u32);
        }
        Some(())
    }

    /// Adds the effect of the edges to the right of a cell to its members, which begin at `start`. Returns the transmittance below them.
    fn complete(&mut self, start: usize, right: &Right, found: &mut Vec<u32>) -> f64 {
        let shapes = found[start..].iter().map(|number| self.edge(*number).shape);
        let lowest = shapes.chain(right.steps.keys().map(|(shape, _)| *shape)).min().unwrap_or(u32::MAX);
        let fold = |passes, (shape, winding): (&u32, &i32)| settle(self.paints, passes, *shape, *winding);
        let below = right.winding.range(..lowest).fold(0.0, fold);
        for (shape, winding) in right.winding.range(lowest..) {
            found.push(self.step(*shape, -f64::MAX, *winding));
        }
        for ((shape, height), turn) in &right.steps {
            found.push(self.step(*shape, f64::from_bits(*height), *turn));
        }
        found[start..].sort_by_key(|number| self.edge(*number).shape);
        below
    }

    /// Returns the number of a step: an edge to the right of everything that starts at a height and has no upper end.
    fn step(&mut self, shape: u32, low: f64, turn: i32) -> u32 {
        *self.steps.entry((shape, low.to_bits(), turn)).or_insert_with(|| {
            self.edges.push(Edge { low, high: f64::INFINITY, x: f64::INFINITY, slope: 0.0, turn, shape });
            self.edges.len() as u32 - 1
        })
    }
}

impl Right {
    /// Adds an edge that lies to the right.
    fn add(&mut self, edge: &Edge, [bottom, top]: [f64; 2], half: f64) {
        // No point of the row lies below its lower side, or below the page; the same above.
        if edge.low <= bottom.max(-half) {
            count(&mut self.winding, edge.shape, edge.turn);
        } else {
            count(&mut self.steps, (edge.shape, edge.low.to_bits()), edge.turn);
        }
        if edge.high <= top.min(half) {
            count(&mut self.steps, (edge.shape, edge.high.to_bits()), -edge.turn);
        }
    }
}

/// Adds `turn` to a count, and removes the count if it becomes 0.
fn count<K: Ord + Copy>(counts: &mut BTreeMap<K, i32>, key: K, turn: i32) {
    let value = counts.entry(key).or_default();
    *value += turn;
    if *value == 0 {
        counts.remove(&key);
    }
}
