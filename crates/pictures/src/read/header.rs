//! Size, shape and kind of a picture.

use super::linear_picture::FileProblem;

/// Size, shape and kind of a picture file.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Width of the picture as it is seen, pixels.
    pub width: u32,
    /// Height of the picture as it is seen, pixels.
    pub height: u32,
    /// Pixels that the file holds beyond the picture on each side: the smaller of left and right, and the smaller of top and bottom.
    pub overscan: [u32; 2],
    /// Width over height of a pixel.
    pub pixel_aspect: f64,
    /// Whether the values are integers, which clip.
    pub clips: bool,
    /// Whether the values are encoded for a display, as in photographs: neither linear nor logarithmic.
    pub is_for_display: bool,
    /// Whether the file is a JPEG.
    pub is_jpeg: bool,
    /// Warnings about the picture that a user should know.
    pub warnings: Vec<FileProblem>,
}

impl Header {
    /// Width over height of the picture.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        f64::from(self.width) * self.pixel_aspect / f64::from(self.height)
    }

    /// Returns the width of the picture with `overscan` pixels on each side, divided by its width without them.
    #[must_use]
    pub fn widened(&self, overscan: [u32; 2]) -> f64 {
        f64::from(self.width + 2 * overscan[0]) / f64::from(self.width)
    }

    /// Returns width over height of the picture with `overscan` pixels on each side.
    #[must_use]
    pub fn aspect_with(&self, overscan: [u32; 2]) -> f64 {
        let [width, height] = [self.width + 2 * overscan[0], self.height + 2 * overscan[1]].map(f64::from);
        width * self.pixel_aspect / height
    }
}
