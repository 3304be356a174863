//! Groups of surfaces that move together: in focusing, in misalignment.

use crate::pose::Displacement;
use crate::{Element, Lens};
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

/// A misalignment of a group.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Misalignment {
    /// Shift along x and y, mm; as the file has it if absent.
    pub decenter_mm: Option<[f64; 2]>,
    /// Tilts about x, y and z, rad, about the vertex of its first surface; as the file has them if absent.
    pub tilt_rad: Option<[f64; 3]>,
    /// Shift along the axis toward the image, mm.
    pub shift_mm: f64,
}

impl Lens {
    /// The same lens with the group of this name out of place; `None` where there is no such group. The other groups and
    /// the image plane stay where they are.
    #[must_use]
    pub fn with_misalignment(mut self, group: &str, by: &Misalignment) -> Option<Self> {
        let at = self.groups.iter().position(|g| g.name == group)?;
        self.shift_elements(self.groups[at].elements.clone(), -by.shift_mm);
        let displacement = &mut self.groups[at].displacement;
        displacement.decenter_mm = by.decenter_mm.unwrap_or(displacement.decenter_mm);
        displacement.tilt_rad = by.tilt_rad.unwrap_or(displacement.tilt_rad);
        self.arrange();
        Some(self)
    }
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
