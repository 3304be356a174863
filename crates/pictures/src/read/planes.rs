//! A picture file as it is: every channel with its values and what the header says, for whoever measures in it.

use super::linear::Trouble;

/// One channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Its name, with that of the part of the file before it where the part has one.
    pub name: String,
    /// Its unit, as this program writes it (`unit NAME`); empty where nothing is said.
    pub unit: String,
    /// Row by row from the top; negative, infinite and undefined values as they stand in the file.
    pub values: Vec<f32>,
}

/// All channels of a picture, upright, and what its header says.
#[derive(Clone, Debug, PartialEq)]
pub struct Planes {
    /// The format, for people.
    pub format: &'static str,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Width over height of a pixel.
    pub pixel_aspect: f64,
    /// The channels in the order of the file; of a file of integers linear `R`, `G` and `B` in the primaries of sRGB.
    pub channels: Vec<Plane>,
    /// Chromaticities x, y of red, green, blue and white, where the header states them or names a space that has them.
    pub chromaticities: Option<[[f64; 2]; 4]>,
    /// Name and text of each attribute of the header that is a text.
    pub attributes: Vec<(String, String)>,
    /// The value from which on integers are clipped, in linear light; `None` for floating point.
    pub clipped_at: Option<f32>,
    /// What a person should know before believing its colors.
    pub doubts: Vec<Trouble>,
}

/// Whether chromaticities of red, green, blue and white are those of CIE XYZ, by which X stands in R, Y in G and Z in B.
pub(super) fn are_of_xyz(xy: &[[f64; 2]; 4]) -> bool {
    let primaries = [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];
    xy.iter().zip(primaries).all(|(a, b)| (a[0] - b[0]).abs() < 1e-4 && (a[1] - b[1]).abs() < 1e-4)
}

impl Planes {
    /// Whether `R`, `G` and `B` hold CIE XYZ, as the chromaticities say.
    #[must_use]
    pub fn holds_xyz(&self) -> bool {
        self.chromaticities.as_ref().is_some_and(are_of_xyz)
    }

    /// The channel of that name.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&Plane> {
        self.channels.iter().find(|c| c.name == name)
    }

    /// The text of that attribute.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(own, _)| own == name).map(|(_, text)| text.as_str())
    }

    /// Number of pixels.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }
}
