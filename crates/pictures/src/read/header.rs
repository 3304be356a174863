//! Shape and kind of a picture.

use super::linear::Trouble;

/// Shape and kind of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Pixels across, as the picture is seen.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Pixels that the file holds beyond the picture to the left and to the right, and above and below: as many as both sides have.
    pub overscan: [u32; 2],
    /// Width over height of a pixel.
    pub pixel_aspect: f64,
    /// Whether its values are integers, which clip.
    pub clips: bool,
    /// Whether its values are encoded for a display, as those of photographs are: neither light nor its logarithm.
    pub is_for_display: bool,
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

    /// Width of the picture with `overscan` pixels on each side over its width without them.
    #[must_use]
    pub fn widened(&self, overscan: [u32; 2]) -> f64 {
        f64::from(self.width + 2 * overscan[0]) / f64::from(self.width)
    }

    /// Width over height of the picture with `overscan` pixels on each side.
    #[must_use]
    pub fn aspect_with(&self, overscan: [u32; 2]) -> f64 {
        let [width, height] = [self.width + 2 * overscan[0], self.height + 2 * overscan[1]].map(f64::from);
        width * self.pixel_aspect / height
    }
}
