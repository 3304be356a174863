//! Where the pixels of a plane lie on the film.

/// The pixels of a plane: how many, how large, and which part of the film they are.
///
/// A plane is row-major, `width * height` values, pixels are square. The pixel in column `i` and row `j` covers
/// `(offset_px[0] + i) * pitch_mm` to `(offset_px[0] + i + 1) * pitch_mm` across the film, and so down it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Raster {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Side of a pixel on the film, mm.
    pub pitch_mm: f64,
    /// Column and row, on the film, of the plane's first pixel.
    pub offset_px: [i64; 2],
}

impl Raster {
    /// A plane that begins at the film's origin.
    #[must_use]
    pub fn new(width: usize, height: usize, pitch_mm: f64) -> Self {
        Self { width, height, pitch_mm, offset_px: [0, 0] }
    }

    /// A part of the same film: `width` by `height` pixels from column `x` and row `y` of this plane on.
    #[must_use]
    pub fn part(&self, x: usize, y: usize, width: usize, height: usize) -> Self {
        let offset_px = [self.offset_px[0] + x as i64, self.offset_px[1] + y as i64];
        Self { width, height, pitch_mm: self.pitch_mm, offset_px }
    }

    /// Number of pixels.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.width * self.height
    }
}
