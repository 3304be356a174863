//! Pattern of the color filters over the pixels.

use schemars::JsonSchema;
use serde::Deserialize;

/// A mosaic of 2 x 2 color filters, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// No filters: all pixels have the same sensitivity.
    Monochrome,
    /// A Bayer mosaic, row by row from the upper left of the upright picture: 0 red, 1 green, 2 blue (B. E. Bayer, US 3971065).
    Bayer([u8; 4]),
}

/// Name of a filter pattern, as written in a scene.
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
    /// Pattern with this name.
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
    /// Returns the channel that the pixel in this column and row records: 0 red, 1 green, 2 blue; always 0 without filters.
    #[inline(always)]
    #[must_use]
    pub fn channel(self, column: u32, row: u32) -> u32 {
        match self {
            Self::Monochrome => 0,
            Self::Bayer(colors) => u32::from(colors[((row & 1) * 2 + (column & 1)) as usize]),
        }
    }
}
