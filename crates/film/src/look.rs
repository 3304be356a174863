//! How a finished film or print is looked at: what is shown as white and as black, and what surrounds it.

/// What is shown as white.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureWhite {
    /// The clear film or print: a picture as one looks at it.
    #[default]
    Film,
    /// The bare light: what the film holds back of it is seen.
    Lamp,
}

/// What is shown as black.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureBlack {
    /// No light: the medium keeps the black that it has, and a print on paper the flare that the room adds.
    #[default]
    Kept,
    /// The darkest that the print or slide has, as a scan with set ends shows it.
    Stretched,
}

/// What surrounds a picture that is looked at. A picture in the dark looks lighter and softer than the same in a lit room; the
/// screen that shows it is taken to stand in a lit room.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Surround {
    /// A projection in a dark room, as an eye there sees it.
    Dark,
    /// A picture in a dim room, as an eye there sees it.
    Dim,
    /// A lit room: the picture's own density is shown.
    #[default]
    Average,
}

impl Surround {
    /// Exponent of luminance by which the picture is shown in a lit room: c, the impact of the surround, over that of an average one.
    /// 0.525 in the dark, 0.59 in dim light, 0.69 on average (CIE 159:2004, CIECAM02, table 1). Chromaticities stay, as in the system
    /// gamma of ITU-R BT.2100.
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

/// How a finished film or print is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Look {
    /// What is shown as white.
    pub white: PictureWhite,
    /// What is shown as black.
    pub black: PictureBlack,
    /// What surrounds it.
    pub surround: Surround,
}

/// Light of the room that the surface of a print on paper reflects, as a part of what its white does: assumed, as in the viewing
/// conditions of reflection prints, where 0.3 to 1 % are usual.
pub const FLARE: f64 = 0.005;
