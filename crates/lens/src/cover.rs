//! A lens on a camera that has plates before its frame.

use crate::Lens;
use spectra_core::cover::CoverStack;

impl Lens {
    /// The same lens on a camera with plates right before its frame: the image plane stands as much farther back as they
    /// move the paraxial image at the reference line, and every search for the best focus looks through them. The tracer
    /// knows nothing of them: they are the imager's.
    #[must_use]
    pub fn with_cover(mut self, cover: Option<CoverStack>) -> Self {
        let before_mm = self.cover_gap_mm();
        self.cover = cover;
        let gap_mm = self.image_gap_mm() + self.cover_gap_mm() - before_mm;
        self.with_image_gap_mm(gap_mm)
    }

    /// How far behind its image plane the paraxial image lies of an axial point `object_mm` in front of the first vertex
    /// (infinity allowed), mm, through the plates before the frame if there are any.
    #[must_use]
    pub fn paraxial_defocus_mm(&self, object_mm: f64) -> f64 {
        self.paraxial_image_gap_mm(object_mm, self.reference_nm) + self.cover_gap_mm() - self.image_gap_mm()
    }

    /// What the plates add to the last gap, mm; behind an odd number of mirrors gaps are negative.
    fn cover_gap_mm(&self) -> f64 {
        self.cover.as_ref().map_or(0.0, |cover| self.sense_behind() * cover.shift_mm(self.reference_nm))
    }
}
