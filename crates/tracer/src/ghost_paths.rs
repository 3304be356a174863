//! Ghost paths: light that surfaces reflect although they should pass it.

use crate::{Path, Tracer, Travel};

impl Tracer {
    /// Returns the elements that can cause ghosts, because they reflect a part of the light that they should pass. These are the
    /// refracting surfaces, except gratings, surfaces that scatter, and surfaces with an ideal coating and sound cement.
    #[must_use]
    pub fn reflecting(&self) -> Vec<usize> {
        (0..self.surfaces()).filter(|at| self.passage(*at).reflects()).collect()
    }
}

impl Path {
    /// Returns all paths of forward light through a lens of `elements` elements with exactly `order` reflections, an even number.
    /// Reflections occur only at `surfaces`, indices in ascending order. For order 2 these are all pairs of surfaces.
    #[must_use]
    pub fn ghosts(elements: usize, surfaces: &[usize], order: usize) -> Vec<Self> {
        let mut all = Vec::new();
        let mut so_far = Vec::with_capacity(order);
        extend(elements, surfaces, order, &mut so_far, &mut all);
        all
    }

    /// Returns the path without its last step if that step is at `element`; otherwise the whole path.
    #[must_use]
    pub fn before(mut self, element: usize) -> Self {
        if self.steps().last().is_some_and(|step| step.element == element) {
            self.truncate_last();
        }
        self
    }
}

fn extend(elements: usize, surfaces: &[usize], order: usize, so_far: &mut Vec<usize>, all: &mut Vec<Path>) {
    if so_far.len() == order {
        all.extend(Path::reflected(elements, Travel::Forward, so_far));
        return;
    }
    let last = so_far.last().copied();
    // Light runs forward after an even number of reflections.
    let forward = so_far.len().is_multiple_of(2);
    for &next in surfaces {
        if last.is_none_or(|last| if forward { next > last } else { next < last }) {
            so_far.push(next);
            extend(elements, surfaces, order, so_far, all);
            so_far.pop();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_and_every_four_are_there_once() {
        // Pairs: n (n - 1) / 2. Sets of four: a > b < c > d, counted by hand for three surfaces.
        assert_eq!(Path::ghosts(11, &[0, 1, 2, 3, 4, 6, 7, 8, 9, 10], 2).len(), 45);
        let four = Path::ghosts(3, &[0, 1, 2], 4);
        let mut reflections: Vec<Vec<usize>> = four.iter().map(|p| p.reflections().collect()).collect();
        let mut want = Vec::new();
        for a in 0..3 {
            for b in 0..a {
                for c in b + 1..3 {
                    want.extend((0..c).map(|d| vec![a, b, c, d]));
                }
            }
        }
        reflections.sort();
        want.sort();
        assert_eq!(reflections, want);
    }
}
