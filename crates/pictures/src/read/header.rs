//! Shape and kind of a picture.

use super::linear::Trouble;

/// Shape and kind of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Pixels across, as the picture is seen.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Width over height of a pixel.
    pub pixel_aspect: f64,
    /// Whether its values are integers, which clip.
    pub clips: bool,
    /// Whether it is a JPEG.
    pub is_jpeg: bool,
    /// What it says that a person should know before believing the picture.
    pub doubts: Vec<Trouble>,
}

impl Header {
    /// Width over height of the picture.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        f64::from(self.width) * self.pixel_aspect / f64::from(self.height)
    }
}
