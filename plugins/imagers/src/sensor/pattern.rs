//! Which filter lies over which pixel.

/// A mosaic of 2 x 2 color filters, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// No filters: every pixel sees alike.
    Monochrome,
    /// Rows from the upper left of the upright picture: 0 red, 1 green, 2 blue (B. E. Bayer, US 3971065).
    Bayer([u8; 4]),
}

/// Names in a scene, with their patterns.
pub const PATTERNS: [(&str, Pattern); 5] = [
    ("rggb", Pattern::Bayer([0, 1, 1, 2])),
    ("bggr", Pattern::Bayer([2, 1, 1, 0])),
    ("grbg", Pattern::Bayer([1, 0, 2, 1])),
    ("gbrg", Pattern::Bayer([1, 2, 0, 1])),
    ("monochrome", Pattern::Monochrome),
];

impl Pattern {
    /// The channel of a pixel.
    #[inline(always)]
    #[must_use]
    pub fn channel(self, column: u32, row: u32) -> u32 {
        match self {
            Self::Monochrome => 0,
            Self::Bayer(colors) => u32::from(colors[((row & 1) * 2 + (column & 1)) as usize]),
        }
    }
}
