//! Focusing: by moving the whole lens, or groups of it by laws; by paraxial optics, or by a search with real rays.
//!
//! The prescription's last gap is the designer's focus for infinity, which on a fast lens is not the
//! paraxial one. Focusing at a distance moves the lens by the paraxial extension from there, as its
//! helicoid does, so that infinity stays exactly where the patent puts it. With laws for groups the image plane stays
//! too, and groups move until the paraxial image is as far from it as it was at infinity.

mod law;
mod rings;
mod search;
mod travel;

pub use law::{FocusLaw, FocusTable, GroupTravel};
pub use search::{Criterion, FocusSearch};

use crate::Lens;

/// Why a distance cannot be focused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FocusError {
    /// The object is at or inside of the front focal point: there is no real image.
    #[error("an object nearer than {nearest_mm:.1} mm to the first surface has no real image")]
    TooNear {
        /// The front focal point, mm in front of the first vertex.
        nearest_mm: f64,
    },
    /// The table of a group ends before this distance.
    #[error("the focusing table of group `{group}` goes from {nearest_mm} to {farthest_mm} mm")]
    BeyondTable {
        /// The group.
        group: String,
        /// Its nearest distance, mm.
        nearest_mm: f64,
        /// Its farthest, mm; may be infinite.
        farthest_mm: f64,
    },
    /// A group runs into its neighbor.
    #[error("group `{group}` would run into surface {surface}")]
    Collision {
        /// The group.
        group: String,
        /// Number of the surface in its way, from 1.
        surface: usize,
    },
    /// No travel of the groups focuses there.
    #[error("no travel of the focusing groups gives an image of what is {object_mm} mm in front of the first surface")]
    NoTravel {
        /// The object, mm in front of the first vertex.
        object_mm: f64,
    },
    /// No light to search with.
    #[error("no light from {object_mm} mm, {field_deg} degrees off the axis, passes the lens")]
    NoLight {
        /// The object, mm in front of the first vertex.
        object_mm: f64,
        /// Its field angle, degrees.
        field_deg: f64,
    },
    /// A medium without an index in the light of the search.
    #[error(transparent)]
    Medium(#[from] spectra_glass::DispersionError),
}

impl Lens {
    /// Distance from the last vertex to the image plane, mm, that focuses an object `object_mm` in
    /// front of the first vertex (infinity allowed) by moving the whole lens.
    ///
    /// # Errors
    /// [`FocusError::TooNear`].
    pub fn focused_gap_mm(&self, object_mm: f64) -> Result<f64, FocusError> {
        let infinity = self.paraxial_image_gap_mm(f64::INFINITY, self.reference_nm);
        let near = -self.first_order(self.reference_nm).ffl_mm;
        if object_mm <= near.max(0.0) {
            return Err(FocusError::TooNear { nearest_mm: near.max(0.0) });
        }
        Ok(self.image_gap_mm() + self.paraxial_image_gap_mm(object_mm, self.reference_nm) - infinity)
    }

    /// The same lens, which stands as its file has it, focused: by its laws if it has any (see [`FocusLaw`]), otherwise
    /// as a whole (see [`Lens::focused_gap_mm`]).
    ///
    /// # Errors
    /// [`FocusError`].
    pub fn focused_at(self, object_mm: f64) -> Result<Self, FocusError> {
        let mut lens = if self.focus_laws.is_empty() {
            let gap = self.focused_gap_mm(object_mm)?;
            self.with_image_gap_mm(gap)
        } else {
            self.focused_by_laws(object_mm)?
        };
        lens.focused_mm = object_mm;
        Ok(lens)
    }
}
