//! A lens on a camera with plates in front of its frame.

use crate::Lens;
use spectra_core::cover::CoverStack;

impl Lens {
    /// Returns the lens on a camera with plates directly in front of its frame (`None`: without plates). The image plane moves
    /// back by the distance that the plates shift the paraxial image at the reference line. Every search for the best focus looks
    /// through the plates. The tracer does not know the plates, which belong to the imager.
    #[must_use]
    pub fn with_cover(mut self, cover: Option<CoverStack>) -> Self {
        let before_mm = self.cover_gap_mm();
        self.cover = cover;
        let gap_mm = self.image_gap_mm() + self.cover_gap_mm() - before_mm;
        self.with_image_gap_mm(gap_mm)
    }

    /// Returns how far (mm) the paraxial image of an axial point lies behind the image plane. The point lies `object_mm` in front
    /// of the first vertex (infinity allowed). Plates in front of the frame are included.
    #[must_use]
    pub fn paraxial_defocus_mm(&self, object_mm: f64) -> f64 {
        self.paraxial_image_gap_mm(object_mm, self.reference_nm) + self.cover_gap_mm() - self.image_gap_mm()
    }

    /// Returns the distance that the plates add to the last gap, mm; behind an odd number of mirrors gaps are negative.
    fn cover_gap_mm(&self) -> f64 {
        self.cover.as_ref().map_or(0.0, |cover| self.sense_behind() * cover.shift_mm(self.reference_nm))
    }
}
