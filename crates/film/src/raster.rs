//! Pixel grid of a plane on the film.

/// Pixel grid of a plane: number of pixels, their size, and the part of the film that they cover.
///
/// A plane holds `width * height` values in row-major order; pixels are square. The pixel in column `i` and row `j` covers `(offset_px[0] +
/// i) * pitch_mm` to `(offset_px[0] + i + 1) * pitch_mm` across the film, and correspondingly down the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Raster {
    /// Number of pixels across.
    pub width: usize,
    /// Number of pixels down.
    pub height: usize,
    /// Side of a pixel on the film, mm.
    pub pitch_mm: f64,
    /// Column and row on the film of the plane's first pixel.
    pub offset_px: [i64; 2],
}

impl Raster {
    /// Builds a grid that begins at the film's origin.
    #[must_use]
    pub fn new(width: usize, height: usize, pitch_mm: f64) -> Self {
        Self { width, height, pitch_mm, offset_px: [0, 0] }
    }

    /// Returns a part of this grid: `width` by `height` pixels from column `x` and row `y` on.
    #[must_use]
    pub fn part(&self, x: usize, y: usize, width: usize, height: usize) -> Self {
        let offset_px = [self.offset_px[0] + x as i64, self.offset_px[1] + y as i64];
        Self { width, height, pitch_mm: self.pitch_mm, offset_px }
    }

    /// Number of pixels of the plane.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.width * self.height
    }
}
