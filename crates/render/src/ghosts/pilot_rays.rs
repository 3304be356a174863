//! The rays that the pilot saw on one path in all rounds together, and the cells that they are sorted into.

use super::guide::{Aim, FrontRect, Guide};
use super::neighbors;
use super::path_cells;
use super::pilot_hit::{Contribution, PilotHit, light};
use super::tree::Tree;

/// The rays seen on one path. The rays of all rounds form one set; the density of an aim is the density of that set, in rays.
#[derive(Default)]
pub(super) struct PilotRays {
    rounds: Vec<(Vec<Guide>, f64)>,
    all: Vec<PilotHit>,
}

impl PilotRays {
    /// Adds a round of `rays` rays.
    pub fn add(&mut self, guides: Vec<Guide>, rays: f64, came: Vec<PilotHit>) {
        for old in &mut self.all {
            old.aim.density += rays * guides[old.zone].density(old.aim.place);
        }
        let before = &self.rounds;
        self.all.extend(came.into_iter().map(|seen| {
            let earlier = before.iter().map(|(guides, rays)| rays * guides[seen.zone].density(seen.aim.place));
            let density = earlier.sum::<f64>() + rays * seen.aim.density;
            PilotHit { aim: Aim { density, ..seen.aim }, ..seen }
        }));
        self.rounds.push((guides, rays));
    }

    /// Iterates over the rays: the block of each, and its contribution to the light.
    pub fn light(&self, of: fn(&Contribution) -> f64) -> impl Iterator<Item = (usize, f64)> {
        light(&self.all, 1.0, of)
    }

    /// Sorts the rays into cells, as small as the number of rays allows. `over` is a factor for the squares of each block.
    pub fn sorted(&self, over: &[f64]) -> Sorted {
        let zones = self.rounds.last().map_or(0, |(guides, _)| guides.len());
        let places = |zone: usize| self.all.iter().filter(move |seen| seen.zone == zone).map(|seen| seen.aim.place);
        let parts = self.rounds.last().into_iter().flat_map(|(guides, _)| guides).map(Guide::part);
        let parts: Vec<FrontRect> = parts.enumerate().map(|(zone, part)| part.with(places(zone))).collect();
        let tree = |zone: usize| Tree::around(places(zone).filter_map(|place| parts[zone].inside(place)).collect());
        let trees: Vec<Tree> = (0..zones).map(tree).collect();
        let firsts: Vec<usize> = trees
            .iter()
            .scan(0, |next, tree| {
                let first = *next;
                *next += tree.leaves();
                Some(first)
            })
            .collect();
        let mut pieces = Vec::new();
        for (seen, ways) in self.all.iter().zip(neighbors::around(&self.all)) {
            let square = seen.brought.judged * seen.brought.judged / seen.aim.density * over[seen.block];
            for ([dx, dy], share) in neighbors::parts(ways) {
                let place = [seen.aim.place[0] + dx, seen.aim.place[1] + dy];
                if let Some(at) = parts[seen.zone].inside(place) {
                    let cell = (firsts[seen.zone] + trees[seen.zone].leaf(at)) as u32;
                    pieces.push((cell, seen.block as u32, share * square));
                }
            }
        }
        let pieces = summed(&pieces, firsts.last().map_or(0, |first| first + trees[zones - 1].leaves()));
        Sorted { parts, trees, pieces }
    }
}

/// Merges contributions from the same cell to the same block. The result is ordered by cell, and by block within each cell.
fn summed(pieces: &[(u32, u32, f64)], cells: usize) -> Vec<(u32, u32, f64)> {
    let mut ends = vec![0_usize; cells + 1];
    pieces.iter().for_each(|(cell, ..)| ends[*cell as usize + 1] += 1);
    (0..cells).for_each(|cell| ends[cell + 1] += ends[cell]);
    let mut by_cell = vec![(0_u32, 0.0_f64); pieces.len()];
    let mut next = ends.clone();
    for (cell, block, square) in pieces {
        by_cell[next[*cell as usize]] = (*block, *square);
        next[*cell as usize] += 1;
    }
    let mut sums: Vec<(u32, u32, f64)> = Vec::new();
    for cell in 0..cells {
        let first = sums.len();
        let own = &mut by_cell[ends[cell]..ends[cell + 1]];
        own.sort_by_key(|(block, _)| *block);
        for (block, square) in own {
            match sums[first..].last_mut() {
                Some((_, last, sum)) if last == block => *sum += *square,
                _ => sums.push((cell as u32, *block, *square)),
            }
        }
    }
    sums
}

/// The cells of a path, zone by zone, and what comes from each cell to each block: an estimate of the integral of the square.
pub(super) struct Sorted {
    parts: Vec<FrontRect>,
    pub trees: Vec<Tree>,
    pub pieces: Vec<(u32, u32, f64)>,
}

impl Sorted {
    pub fn leaves(&self) -> usize {
        self.trees.iter().map(Tree::leaves).sum()
    }

    /// Returns the guides with the least noise for the given weights of the blocks' noise, and the variance of one ray.
    pub fn guides(&self, weights: &[f64]) -> (Vec<Guide>, f64) {
        let mut squares = vec![0.0; self.leaves()];
        self.pieces
            .iter()
            .for_each(|(cell, block, square)| squares[*cell as usize] += weights[*block as usize] * square);
        let (dense, variance) = path_cells::best(&self.trees, &squares);
        let guide = |((part, tree), dense): ((&FrontRect, &Tree), Vec<f64>)| {
            if dense.iter().all(|dense| *dense == 0.0) {
                return Guide::blind();
            }
            Guide::of(*part, tree.density(&dense))
        };
        (self.parts.iter().zip(&self.trees).zip(dense).map(guide).collect(), variance)
    }
}
