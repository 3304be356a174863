//! Groups of surfaces that move together.

use crate::Element;
use crate::pose::Displacement;
use std::ops::Range;

/// Surfaces that move together.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Its name in the file.
    pub name: String,
    /// Its elements, by index.
    pub elements: Range<usize>,
    /// The element about whose vertex it is tilted, by index: its first, unless the lens is turned round.
    pub about: usize,
    /// Shift and tilt of the whole group about that vertex: a misalignment.
    pub displacement: Displacement,
}

impl Group {
    /// Moves its elements from where they stand.
    pub(crate) fn displace(&self, elements: &mut [Element]) {
        if self.displacement.is_none() || self.elements.is_empty() {
            return;
        }
        let first = &elements[self.about];
        let about = if first.reversed { first.pose.reversed() } else { first.pose };
        let moved = about.then(&self.displacement.pose()).then(&about.inverse());
        for e in &mut elements[self.elements.clone()] {
            e.pose = moved.then(&e.pose);
        }
    }
}
