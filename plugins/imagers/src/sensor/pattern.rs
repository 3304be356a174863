//! Which filter lies over which pixel.

use schemars::JsonSchema;
use serde::Deserialize;

/// A mosaic of 2 x 2 color filters, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// No filters: every pixel sees alike.
    Monochrome,
    /// Rows from the upper left of the upright picture: 0 red, 1 green, 2 blue (B. E. Bayer, US 3971065).
    Bayer([u8; 4]),
}

/// A pattern by its name in a scene.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
#[allow(missing_docs, reason = "the letters are the pattern")]
pub enum PatternName {
    #[default]
    Rggb,
    Bggr,
    Grbg,
    Gbrg,
    Monochrome,
}

impl PatternName {
    /// The pattern.
    #[must_use]
    pub fn pattern(self) -> Pattern {
        match self {
            Self::Rggb => Pattern::Bayer([0, 1, 1, 2]),
            Self::Bggr => Pattern::Bayer([2, 1, 1, 0]),
            Self::Grbg => Pattern::Bayer([1, 0, 2, 1]),
            Self::Gbrg => Pattern::Bayer([1, 2, 0, 1]),
            Self::Monochrome => Pattern::Monochrome,
        }
    }
}

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
