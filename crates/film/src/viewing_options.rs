//! Viewing choices for a finished film or print: its white, its black and its surround.

/// The light that is shown as white.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureWhite {
    /// The clear film or print is white, as in a picture that one views.
    #[default]
    Film,
    /// The bare light is white: the light that the clear film absorbs is visible.
    Lamp,
}

/// The light that is shown as black.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureBlack {
    /// No light is black: the medium keeps its own black, and a print on paper also the flare of the room.
    #[default]
    Kept,
    /// The darkest tone of the print or slide is black, as in a scan with set end points.
    Stretched,
}

/// Surround of a viewed picture. A picture in the dark looks lighter and softer than the same picture in a lit room. The screen that shows
/// it is assumed to be in a lit room.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Surround {
    /// A projection in a dark room, as an eye sees it there.
    Dark,
    /// A picture in a dim room, as an eye sees it there.
    Dim,
    /// A picture in a lit room: its own density is shown.
    #[default]
    Average,
}

impl Surround {
    /// Exponent of luminance that shows the picture in a lit room.
    ///
    /// The exponent is the impact of the surround, c, divided by that of an average one.
    /// c is 0.525 in the dark, 0.59 in dim light and 0.69 for an average surround (CIE 159:2004, CIECAM02, table 1). Chromaticities do not
    /// change, as in the system gamma of ITU-R BT.2100.
    #[must_use]
    pub fn exponent(self) -> f64 {
        const AVERAGE: f64 = 0.69;
        match self {
            Self::Dark => 0.525 / AVERAGE,
            Self::Dim => 0.59 / AVERAGE,
            Self::Average => 1.0,
        }
    }
}

/// Viewing conditions of a finished film or print.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ViewingOptions {
    /// The light that is shown as white.
    pub white: PictureWhite,
    /// The light that is shown as black.
    pub black: PictureBlack,
    /// Surround in which the picture is viewed.
    pub surround: Surround,
}

/// Room light reflected by the surface of a paper print, as a fraction of the light from its white. Assumed, as in viewing conditions for
/// reflection prints, where 0.3 to 1 % is usual.
pub const FLARE: f64 = 0.005;
