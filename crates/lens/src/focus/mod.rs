//! Focusing: the whole lens, or groups of it by their focusing laws, move so that the paraxial image stays sharp.
//!
//! The last gap in the prescription is the designer's focus for infinity. On a fast lens this is not the paraxial focus.
//! Without focusing laws, focusing at a distance moves the whole lens forward from there by the paraxial extension, as its helicoid does.
//! Infinity thus stays exactly where the patent puts it. With focusing laws for groups the image plane stays
//! too, and groups move until the paraxial image is as far from it as it was at infinity.

mod law;
mod travel;

pub use law::{FocusLaw, FocusTable, GroupTravel};

use crate::Lens;

/// The reason why a lens cannot be focused at a distance.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FocusError {
    /// The object lies at or inside the front focal point, so there is no real image.
    #[error("an object nearer than {nearest_mm:.1} mm to the first surface has no real image")]
    TooNear {
        /// Distance of the front focal point in front of the first vertex, mm.
        nearest_mm: f64,
    },
    /// The distance lies outside the focusing table of a group.
    #[error("the focusing table of group `{group}` goes from {nearest_mm} to {farthest_mm} mm")]
    BeyondTable {
        /// Name of the group whose table ends.
        group: String,
        /// Nearest distance in the table, mm.
        nearest_mm: f64,
        /// Farthest distance in the table, mm; may be infinite.
        farthest_mm: f64,
    },
    /// A group would run into its neighbor.
    #[error("group `{group}` would run into surface {surface}")]
    Collision {
        /// Name of the group that moves.
        group: String,
        /// Number of the surface in the way, from 1.
        surface: usize,
    },
    /// No travel of the groups focuses an object at this distance.
    #[error(
        "no travel of the focusing groups brings an object {object_mm} mm in front of the first surface into focus"
    )]
    NoTravel {
        /// Distance of the object in front of the first vertex, mm.
        object_mm: f64,
    },
    /// No light passes the lens, so the focus cannot be searched.
    #[error("no light from an object at {object_mm} mm, {field_deg} degrees off the axis, passes the lens")]
    NoLight {
        /// Distance of the object in front of the first vertex, mm.
        object_mm: f64,
        /// Field angle of the object, degrees.
        field_deg: f64,
    },
    /// A medium has no index at a wavelength of the search.
    #[error(transparent)]
    Medium(#[from] spectra_glass::DispersionError),
}

impl Lens {
    /// Returns the distance (mm) from the last vertex to the image plane at which an object is in focus, if the whole lens moves.
    /// The object lies `object_mm` in front of the first vertex (infinity allowed).
    ///
    /// # Errors
    /// [`FocusError::TooNear`] if the object lies at or inside the front focal point.
    pub fn focused_gap_mm(&self, object_mm: f64) -> Result<f64, FocusError> {
        let infinity = self.paraxial_image_gap_mm(f64::INFINITY, self.reference_nm);
        let near = -self.first_order(self.reference_nm).ffl_mm;
        if object_mm <= near.max(0.0) {
            return Err(FocusError::TooNear { nearest_mm: near.max(0.0) });
        }
        Ok(self.image_gap_mm() + self.paraxial_image_gap_mm(object_mm, self.reference_nm) - infinity)
    }

    /// Focuses the lens on an object `object_mm` in front of the first vertex (infinity allowed). The groups of the lens must be
    /// in the positions that its file states. They move by their focusing laws (see [`FocusLaw`]); without laws the whole lens
    /// moves (see [`Lens::focused_gap_mm`]).
    ///
    /// # Errors
    /// [`FocusError`] if the lens cannot be focused at this distance.
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
