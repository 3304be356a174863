//! Shape and kind of a picture.

/// Shape and kind of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
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
}

impl Header {
    /// Width over height of the picture.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        f64::from(self.width) * self.pixel_aspect / f64::from(self.height)
    }
}
