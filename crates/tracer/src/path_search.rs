//! Finds paths with many reflections by branch and bound.
//!
//! The light that a surface reflects out of a path is an upper bound for every longer path that continues there: no coating, rim or total
//! reflection further on can add to it. So a search follows the light itself, path by path, and cuts a branch that begins
//! with too little light to matter. The caller books what is cut, so no light is lost from sight.

use crate::{Interaction, Ledger, Path, Travel};

/// The limits of a search for paths with many reflections.
#[derive(Clone, Copy, Debug)]
pub struct PathSearch<'a> {
    /// Number of elements of the lens.
    pub elements: usize,
    /// Indices of the elements that may reflect, ascending.
    pub surfaces: &'a [usize],
    /// Largest number of reflections of a path.
    pub order: usize,
    /// Amount of light below which a branch with more than two reflections is cut, in the unit of the ledgers.
    pub least: f64,
}

impl PathSearch<'_> {
    /// Follows the path with these `reflections` and all paths that branch off it. `came` is the light of the path at its last
    /// reflection. `visit` gets each path and the light with which it begins, traces it and returns its ledger; it must use the
    /// same rays for all paths. Returns the light of branches that are not followed.
    ///
    /// # Panics
    /// If the reflections cannot follow one another.
    pub fn follow(&self, reflections: &mut Vec<usize>, came: f64, visit: &mut dyn FnMut(&Path, f64) -> Ledger) -> f64 {
        let path = Path::reflected(self.elements, Travel::Forward, reflections).expect("surfaces in their order");
        let ledger = visit(&path, came);
        let turns = |act: Interaction| act == Interaction::Reflect;
        let own = path.steps().iter().rposition(|step| turns(step.act)).map_or(0, |last| last + 1);
        let mut left = 0.0;
        for (step, lost) in path.steps().iter().zip(&ledger.steps).skip(own) {
            let goes_on = reflections.len() < self.order && self.surfaces.binary_search(&step.element).is_ok();
            if goes_on && (reflections.len() < 2 || lost.elsewhere > self.least) {
                reflections.push(step.element);
                left += self.follow(reflections, lost.elsewhere, visit);
                reflections.pop();
            } else {
                left += lost.elsewhere;
            }
        }
        left
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StepLedger;

    /// Each surface reflects a tenth of its light. Every path of the enumeration is visited once, and none begins
    /// with less light than requested.
    #[test]
    fn branches_are_cut_where_little_begins() {
        let surfaces = [0, 1, 2, 3];
        let search = |order: usize, least: f64| {
            let mut seen: Vec<(Vec<usize>, f64)> = Vec::new();
            let branches = PathSearch { elements: 4, surfaces: &surfaces, order, least };
            let mut visit = |path: &Path, came: f64| {
                seen.push((path.reflections().collect(), came));
                let mut light = if seen.len() == 1 { 1.0 } else { came };
                let last = path.steps().iter().rposition(|s| s.act == Interaction::Reflect).map_or(0, |last| last + 1);
                let steps = path.steps().iter().enumerate().map(|(at, _)| {
                    let elsewhere = if at >= last { 0.1 * light } else { 0.0 };
                    light -= elsewhere;
                    StepLedger { elsewhere, ..StepLedger::default() }
                });
                Ledger { steps: steps.collect(), ..Ledger::default() }
            };
            let left = branches.follow(&mut Vec::new(), 0.0, &mut visit);
            (seen, left)
        };
        let (all, left) = search(4, 0.0);
        for order in [2, 4] {
            let mut own: Vec<_> = all.iter().map(|(path, _)| path.clone()).filter(|path| path.len() == order).collect();
            let mut want: Vec<Vec<usize>> =
                Path::ghosts(4, &surfaces, order).iter().map(|path| path.reflections().collect()).collect();
            own.sort();
            want.sort();
            assert_eq!(own, want);
        }
        let (some, more) = search(4, 5e-4);
        assert!(some.len() < all.len() && some.iter().all(|(path, came)| path.len() < 3 || *came > 5e-4));
        // The light that is cut equals what the full search followed there, plus what that search left.
        assert!(more > left && left > 0.0, "{more} {left}");
        let (pairs, _) = search(2, f64::INFINITY);
        assert_eq!(pairs.len(), 1 + 4 + 6);
    }
}
