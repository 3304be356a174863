//! Misalignment: groups of surfaces that are shifted or tilted.

use crate::Lens;

/// A misalignment of one group of surfaces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Misalignment {
    /// Shift along x and y, mm; if `None`, the shift in the lens file stays.
    pub decenter_mm: Option<[f64; 2]>,
    /// Tilts about x, y and z through the vertex of the group's first surface, rad; if `None`, the tilt in the lens file stays.
    pub tilt_rad: Option<[f64; 3]>,
    /// Shift along the axis toward the image, mm.
    pub shift_mm: f64,
}

impl Lens {
    /// Returns the lens with the group called `group` misaligned; `None` if there is no such group. The other groups and the
    /// image plane stay where they are.
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
