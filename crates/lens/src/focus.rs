//! Focusing by moving the whole lens.
//!
//! The prescription's last gap is the designer's focus for infinity, which on a fast lens is not the
//! paraxial one. Focusing at a distance moves the lens by the paraxial extension from there, as its
//! helicoid does, so that infinity stays exactly where the patent puts it.

use crate::Lens;

/// Why a distance cannot be focused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FocusError {
    /// The object is at or inside of the front focal point: there is no real image.
    #[error("nothing nearer than {nearest_mm:.1} mm in front of the first surface has a real image")]
    TooNear {
        /// The front focal point, mm in front of the first vertex.
        nearest_mm: f64,
    },
}

impl Lens {
    /// Distance from the last vertex to the image plane, mm, that focuses an object `object_mm` in
    /// front of the first vertex (infinity allowed).
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

    /// The same lens, focused; see [`Lens::focused_gap_mm`].
    ///
    /// # Errors
    /// [`FocusError::TooNear`].
    pub fn focused_at(self, object_mm: f64) -> Result<Self, FocusError> {
        let gap = self.focused_gap_mm(object_mm)?;
        Ok(self.with_image_gap_mm(gap))
    }
}
