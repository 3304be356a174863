//! Groups of surfaces that move together.

use crate::Element;
use crate::pose::Displacement;
use std::ops::Range;

/// A group of surfaces that move together.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Name of the group in the lens file.
    pub name: String,
    /// Indices of the elements in the group.
    pub elements: Range<usize>,
    /// Index of the element about whose vertex the group is tilted: the first of the group, unless the lens is reversed.
    pub about: usize,
    /// Shift and tilt of the whole group about the vertex of element `about`.
    pub displacement: Displacement,
}

impl Group {
    /// Applies the displacement of the group to the poses of its elements.
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
