//! Paths by many reflections, found by branch and bound.
//!
//! What a surface sends back of the light of a path is all that any longer path has which goes on there: no coating, rim or total
//! reflection further on can add to it. So a search follows the light itself, path by path, and cuts a branch where what it begins
//! with is too little to matter. What is cut is booked by whoever follows: nothing is lost from sight.

use crate::{Act, Ledger, Path, Travel};

/// How far a search goes.
#[derive(Clone, Copy, Debug)]
pub struct Branches<'a> {
    /// Elements of the lens.
    pub elements: usize,
    /// Those that reflect, in rising order.
    pub surfaces: &'a [usize],
    /// Reflections of a path at most.
    pub order: usize,
    /// A branch of more than two reflections that begins with less than this is cut, in the unit of the ledgers.
    pub least: f64,
}

impl Branches<'_> {
    /// Follows a path, which has `came` to it at its last reflection, and all that branch off it. `visit` gets each of them with what
    /// came to it so, and says what became of its light; its rays have to be the same for all. Returns what is reflected once more and
    /// not followed.
    ///
    /// # Panics
    /// The reflections do not follow from one another.
    pub fn follow(&self, reflections: &mut Vec<usize>, came: f64, visit: &mut dyn FnMut(&Path, f64) -> Ledger) -> f64 {
        let path = Path::reflected(self.elements, Travel::Forward, reflections).expect("surfaces in their order");
        let ledger = visit(&path, came);
        let turns = |act: Act| act == Act::Reflect;
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

    /// Each surface sends back a tenth of what comes: of all paths each is visited once, those of the enumeration, and none begins
    /// with less than asked.
    #[test]
    fn branches_are_cut_where_little_begins() {
        let surfaces = [0, 1, 2, 3];
        let search = |order: usize, least: f64| {
            let mut seen: Vec<(Vec<usize>, f64)> = Vec::new();
            let branches = Branches { elements: 4, surfaces: &surfaces, order, least };
            let mut visit = |path: &Path, came: f64| {
                seen.push((path.reflections().collect(), came));
                let mut light = if seen.len() == 1 { 1.0 } else { came };
                let last = path.steps().iter().rposition(|s| s.act == Act::Reflect).map_or(0, |last| last + 1);
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
        // What is cut is what the search to the end followed there, with what that left.
        assert!(more > left && left > 0.0, "{more} {left}");
        let (pairs, _) = search(2, f64::INFINITY);
        assert_eq!(pairs.len(), 1 + 4 + 6);
    }
}
