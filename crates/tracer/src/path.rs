//! A path of light through a lens, as data: the order of the elements, and what the light does at each.
//!
//! Each step states what the light does (as built, or a reflection at a refracting surface) and the direction in which it arrives.
//! `Tracer::route` prepares a path, and `Tracer::follow` traces batches along it. The straight paths, forward and backward, are two such
//! paths, and ghosts are traced exactly like them.

use crate::Travel;

/// What light does at an element of its path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interaction {
    /// The element acts as the prescription says: a glass surface refracts, a mirror reflects, a stop passes light.
    AsBuilt,
    /// A refracting surface reflects a part of the light, which the designer did not intend.
    Reflect,
}

/// One step of a [`Path`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathStep {
    /// Element at this step: index into [`spectra_lens::Lens::elements`].
    pub element: usize,
    /// What the light does at the element.
    pub act: Interaction,
    /// Direction in which the light arrives: in the order of the prescription ([`Travel::Forward`]) or against it.
    pub travel: Travel,
}

/// A path of light through a lens: straight through, or with reflections at refracting surfaces.
///
/// The light enters at the front (in the frame of the lens) or at the rear (in the frame of the image plane), and leaves where the last
/// step leads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Path {
    enters: Travel,
    leaves: Travel,
    steps: Vec<PathStep>,
}

/// The reason why a list of reflections does not form a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PathError {
    /// The lens has no such element.
    #[error("the lens has {elements} surfaces, there is no surface {}", .element + 1)]
    NoElement {
        /// Index of the requested element.
        element: usize,
        /// Number of elements that the lens has.
        elements: usize,
    },
    /// Light from one reflection cannot reach the next reflection.
    #[error("light reflected by surface {} does not reach surface {} next", .from + 1, .to + 1)]
    OutOfReach {
        /// Index of the element that reflects the light.
        from: usize,
        /// Index of the element that should reflect next.
        to: usize,
    },
}

impl Path {
    /// Returns the straight path through a lens of `elements` elements.
    #[must_use]
    pub fn through(elements: usize, travel: Travel) -> Self {
        let step = |element| PathStep { element, act: Interaction::AsBuilt, travel };
        let steps = match travel {
            Travel::Forward => (0..elements).map(step).collect(),
            Travel::Backward => (0..elements).rev().map(step).collect(),
        };
        Self { enters: travel, leaves: travel, steps }
    }

    /// Returns the path with these reflections, in order, through a lens of `elements` elements. For example, `[7, 3]` with light
    /// that enters at the front means: it is reflected by element 7, then by element 3, and leaves at the rear. After an odd
    /// number of reflections the light leaves where it entered. If there are no reflections this is [`Path::through`].
    ///
    /// # Errors
    /// [`PathError`] if an element does not exist or the light cannot reach the next reflection.
    pub fn reflected(elements: usize, enters: Travel, reflections: &[usize]) -> Result<Self, PathError> {
        let mut steps = Vec::new();
        let mut travel = enters;
        // The next element; beyond either end the light is outside.
        let mut next = if travel == Travel::Forward { 0 } else { elements as isize - 1 };
        let mut from = None;
        for &to in reflections {
            if to >= elements {
                return Err(PathError::NoElement { element: to, elements });
            }
            let ahead = if travel == Travel::Forward { to as isize - next } else { next - to as isize };
            if let (Some(from), true) = (from, ahead < 0) {
                return Err(PathError::OutOfReach { from, to });
            }
            let step = |element, act| PathStep { element, act, travel };
            let way = if travel == Travel::Forward { 1 } else { -1 };
            while next != to as isize {
                steps.push(step(next as usize, Interaction::AsBuilt));
                next += way;
            }
            steps.push(step(to, Interaction::Reflect));
            (travel, next, from) = (turned(travel), to as isize - way, Some(to));
        }
        let rest = match travel {
            Travel::Forward => next.max(0)..elements as isize,
            Travel::Backward => 0..next + 1,
        };
        let rest = rest.map(|element| PathStep { element: element as usize, act: Interaction::AsBuilt, travel });
        match travel {
            Travel::Forward => steps.extend(rest),
            Travel::Backward => steps.extend(rest.rev()),
        }
        Ok(Self { enters, leaves: travel, steps })
    }

    /// Cuts the path behind the first element for which `ends` is true; keeps all of it if there is none.
    #[must_use]
    pub fn up_to(mut self, ends: impl Fn(usize) -> bool) -> Self {
        let last = self.steps.iter().position(|step| ends(step.element));
        self.steps.truncate(last.map_or(self.steps.len(), |last| last + 1));
        self
    }

    /// Removes the last step.
    pub(crate) fn truncate_last(&mut self) {
        self.steps.pop();
    }

    /// Returns the steps, in the order in which light takes them.
    #[must_use]
    pub fn steps(&self) -> &[PathStep] {
        &self.steps
    }

    /// Iterates over the refracting elements at which the path is reflected, in order.
    pub fn reflections(&self) -> impl Iterator<Item = usize> + '_ {
        self.steps.iter().filter(|s| s.act == Interaction::Reflect).map(|s| s.element)
    }

    /// Direction in which light enters the path: forward at the front, backward at the rear.
    #[must_use]
    pub fn enters(&self) -> Travel {
        self.enters
    }

    /// Direction in which light leaves the path: forward at the rear, backward at the front.
    #[must_use]
    pub fn leaves(&self) -> Travel {
        self.leaves
    }
}

fn turned(travel: Travel) -> Travel {
    match travel {
        Travel::Forward => Travel::Backward,
        Travel::Backward => Travel::Forward,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn elements(path: &Path) -> Vec<usize> {
        path.steps().iter().map(|s| s.element).collect()
    }

    #[test]
    fn reflections_turn_the_light_back() {
        let ghost = Path::reflected(5, Travel::Forward, &[3, 1]).unwrap();
        assert_eq!(elements(&ghost), [0, 1, 2, 3, 2, 1, 2, 3, 4]);
        assert_eq!(ghost.reflections().collect::<Vec<_>>(), [3, 1]);
        assert_eq!((ghost.enters(), ghost.leaves()), (Travel::Forward, Travel::Forward));
        let once = Path::reflected(5, Travel::Forward, &[0]).unwrap();
        assert_eq!((elements(&once), once.leaves()), (vec![0], Travel::Backward));
        let back = Path::reflected(3, Travel::Backward, &[1, 2]).unwrap();
        assert_eq!(elements(&back), [2, 1, 2, 1, 0]);
        for travel in [Travel::Forward, Travel::Backward] {
            assert_eq!(Path::reflected(4, travel, &[]).unwrap(), Path::through(4, travel));
        }
    }

    #[test]
    fn light_cannot_jump() {
        let wrong = |reflections: &[usize]| Path::reflected(5, Travel::Forward, reflections).unwrap_err();
        assert_eq!(wrong(&[1, 3]), PathError::OutOfReach { from: 1, to: 3 });
        assert_eq!(wrong(&[3, 3]), PathError::OutOfReach { from: 3, to: 3 });
        assert_eq!(wrong(&[5]), PathError::NoElement { element: 5, elements: 5 });
    }
}
